//! Words of laboratories in many languages, in lower case.

use std::sync::OnceLock;

/// Number of groups of words by the low bits of their first byte, which differ between small letters, so
/// that a word is compared with few others.
const GROUPS: usize = 32;

#[derive(Default)]
struct Sorted {
    whole: [Vec<&'static str>; GROUPS],
    beginnings: [Vec<&'static str>; GROUPS],
    /// Parts of words of languages without spaces, and of long words.
    parts: Vec<&'static str>,
}

/// A list of words with one meaning, as `word|beginning*|*part*`; sorted when first used.
pub(super) struct Words(&'static str, OnceLock<Sorted>);

impl Words {
    pub(super) const fn of(list: &'static str) -> Words {
        Words(list, OnceLock::new())
    }

    pub(super) fn has(&self, word: &str) -> bool {
        let sorted = self.1.get_or_init(|| {
            let mut sorted = Sorted::default();
            for word in self.0.split('|') {
                match word.strip_suffix('*').map(|start| (start, start.strip_prefix('*'))) {
                    Some((_, Some(part))) => sorted.parts.push(part),
                    Some((beginning, None)) => sorted.beginnings[group(beginning)].push(beginning),
                    None => sorted.whole[group(word)].push(word),
                }
            }
            sorted
        });
        let (group, is_ascii) = (group(word), word.is_ascii());
        sorted.whole[group].contains(&word)
            || sorted.beginnings[group].iter().any(|beginning| word.starts_with(beginning))
            // Most words are English and most parts are not.
            || sorted.parts.iter().any(|part| (!is_ascii || part.is_ascii()) && word.contains(part))
    }

    pub(super) fn any(&self, words: &[String]) -> bool {
        words.iter().any(|word| self.has(word))
    }
}

fn group(word: &str) -> usize {
    usize::from(word.bytes().next().unwrap_or(0)) % GROUPS
}

pub(super) static RETAINED: Words = Words::of(
    "retained|coarser|rückstand|siebrückstand|rueckstand|refus|retenido|retenu|oversize|retain|ret|\
     rest|zeefrest|trattenuto|retido|tertahan|kalan|pozostałość|pozostalosc|odsiew|zbytek|zůstatek|\
     zvyšok|остаток|залишок|ostatak|συγκρατούμενο|συγκρατούμενα|stannar|kvarstannande|gjenliggende|\
     sikterest|sigterest|seulalle|fennmaradt|reținut|retinut|retenus|*筛余*|*篩余*|*残留*|*殘留*|*잔류*",
);
pub(super) static FINER: Words = Words::of(
    "percent|finer|passing|pct|percentage|pass|cumulative|smaller|durchgang|siebdurchgang|passant|\
     passants|tamisat|pasa|pasante|passed|massendurchgang|perp|undersize|massenanteil|doorval|\
     przesiew|passa|pas|passante|passato|tamisats|geçen|gecen|przechodzi|propad|prepad|\
     проход|прохід|prolaz|διερχόμενο|διερχόμενα|passerande|passerat|passerar|passert|gjennomgang|\
     gennemfald|läpäisy|áthullott|lolos|trecut|treceri|zeefdoorval|*通过*|*通過*|*小于*|*小於*|*통과*",
);
/// Sieves and their openings.
pub(super) static SIZE: Words = Words::of(
    "opening|size|sieve|diameter|mm|d|openings|aperture|siebgröße|sieböffnung|korngröße|\
     korndurchmesser|maschenweite|tamis|ouverture|diamètre|diametre|tamiz|abertura|particle|phi|φ|\
     screen|mesh|sieves|sizes|korndurchm|siebweite|um|µm|μm|micron|microns|grain|grains|größe|grösse|\
     korn|sieb|malla|maille|dia|diam|apertura|luz|zeef|elek|sito|sita|oczka|síto|сито|сита|κόσκινο|\
     sikt|sikte|sigte|seula|szita|peneira|saringan|setaccio|vaglio|maaswijdte|maskevidde|*筛孔*|\
     *篩孔*|*ふるい*|*粒径*|*粒徑*|*체눈*",
);
pub(super) static MASS: Words = Words::of("mass|weight|masse|gewicht|wt|peso|g|gram|grams|kg|grammes");
pub(super) static INDIVIDUAL: Words =
    Words::of("individual|each|single|partial|on|interval|per|ind|*分计*|*分計*|*частн*|*częściow*");
/// Beginnings and parts of words for cumulative.
pub(super) static CUMULATED: Words =
    Words::of("cum*|*kümül*|*kumul*|*skumul*|*累计*|*累計*|*累积*|*加積*|*누적*|*накоплен*|*полный*");

/// Names of the mass below the finest sieve.
pub(super) static PAN: Words = Words::of(
    "schale|siebpfanne|pfanne|boden|siebboden|auffangschale|auffangboden|fond|fond de tamis|plateau|\
     bac|récipient|recipient|fondo|recipiente|receptáculo|receptaculo|receptor|cazoleta|charola|\
     bandeja|ciego|fundo|prato|coletor|panela|vassoio|piatto|raccoglitore|bodem|zeefpan|opvangbak|\
     dno|denko|miska|tava|tepsi|elek altı|botten|bunn|bund|pohja|поддон|дно|τυφλό|πυθμένας|\
     gyűjtőtálca|tavă|posuda|底|底盘|底盤|筛底|受皿|受け皿|받침|팬|바닥",
);
/// Names of the sum of all rows.
pub(super) static TOTAL: Words = Words::of(
    "summe|gesamt|somme|suma|totale|totaal|toplam|razem|celkem|spolu|итого|всего|сумма|σύνολο|summa|\
     yhteensä|összesen|ukupno|jumlah|合计|合計|합계",
);

pub(super) static MILLIMETRE: Words = Words::of("mm|мм|millimetre|millimeter|millimetres|millimeters");
pub(super) static MICROMETRE: Words = Words::of(
    "um|µm|μm|мкм|µ|μ|mcm|mic|mu|micro|micron*|micrón*|mícron*|micra*|micromet*|micromèt*|\
     micrómet*|micrômet*|mikron*|mikrom*|микрон*|микром*",
);
pub(super) static INCH: Words =
    Words::of("inch|inches|ins|zoll|pulg|pulgada|pulgadas|pol|polegada|polegadas|pouce|pouces|pollici|duim");
