//! Words of laboratories in languages other than English, in lower case; some words of the major
//! languages are with the English ones in `heading`.

/// Splits a text at `|` into `N` words, at compile time.
pub(super) const fn list<const N: usize>(text: &'static str) -> [&'static str; N] {
    let (mut words, mut rest, mut at) = ([""; N], text, 0);
    while at < N {
        let mut end = 0;
        while end < rest.len() && rest.as_bytes()[end] != b'|' {
            end += 1;
        }
        (words[at], rest) = rest.split_at(end);
        at += 1;
        if !rest.is_empty() {
            rest = rest.split_at(1).1;
        }
    }
    assert!(rest.is_empty(), "more words than the list holds");
    words
}

const RETAINED: [&str; 24] = list(
    "retido|tertahan|kalan|pozostałość|pozostalosc|odsiew|zbytek|zůstatek|zvyšok|остаток|залишок|\
     ostatak|συγκρατούμενο|συγκρατούμενα|stannar|kvarstannande|gjenliggende|sikterest|sigterest|\
     seulalle|fennmaradt|reținut|retinut|retenus",
);
const FINER: [&str; 26] = list(
    "pas|passante|passato|tamisats|geçen|gecen|przechodzi|propad|prepad|проход|прохід|prolaz|\
     διερχόμενο|διερχόμενα|passerande|passerat|passerar|passert|gjennomgang|gennemfald|läpäisy|\
     áthullott|lolos|trecut|treceri|zeefdoorval",
);
/// Sieves and their openings.
const SIZE: [&str; 21] = list(
    "elek|sito|sita|oczka|síto|сито|сита|κόσκινο|sikt|sikte|sigte|seula|szita|peneira|saringan|\
     setaccio|vaglio|maaswijdte|maskevidde|粒径|粒徑",
);
/// Stems, and words of languages without spaces.
const RETAINED_WITHIN: [&str; 5] = ["筛余", "篩余", "残留", "殘留", "잔류"];
const FINER_WITHIN: [&str; 5] = ["通过", "通過", "小于", "小於", "통과"];
const SIZE_WITHIN: [&str; 6] = ["筛孔", "篩孔", "ふるい", "粒径", "粒徑", "체눈"];
const CUMULATIVE_WITHIN: [&str; 10] =
    ["kümül", "kumul", "skumul", "累计", "累計", "累积", "加積", "누적", "накоплен", "полный"];
const INDIVIDUAL_WITHIN: [&str; 4] = ["分计", "分計", "частн", "częściow"];
/// Words for the mass below the finest sieve.
const PAN: [&str; 58] = list(
    "schale|siebpfanne|pfanne|boden|siebboden|auffangschale|auffangboden|fond|fond de tamis|plateau|\
     bac|récipient|recipient|fondo|recipiente|receptáculo|receptaculo|receptor|cazoleta|charola|\
     bandeja|ciego|fundo|prato|coletor|panela|vassoio|piatto|raccoglitore|bodem|zeefpan|opvangbak|\
     dno|denko|miska|tava|tepsi|elek altı|botten|bunn|bund|pohja|поддон|дно|τυφλό|πυθμένας|\
     gyűjtőtálca|tavă|posuda|底|底盘|底盤|筛底|受皿|受け皿|받침|팬|바닥",
);
/// Words for the sum of all rows.
const TOTAL: [&str; 22] = list(
    "summe|gesamt|somme|suma|totale|totaal|toplam|razem|celkem|spolu|итого|всего|сумма|σύνολο|summa|\
     yhteensä|összesen|ukupno|jumlah|合计|合計|합계",
);

const MILLIMETRE: [&str; 6] = ["mm", "мм", "millimetre", "millimeter", "millimetres", "millimeters"];
const MICROMETRE: [&str; 10] = ["um", "µm", "μm", "мкм", "µ", "μ", "mcm", "mic", "mu", "micro"];
/// Stems of the words for micrometres.
const MICROMETRES: [&str; 12] =
    list("micron|micrón|mícron|micra|micromet|micromèt|micrómet|micrômet|mikron|mikrom|микрон|микром");
const MICROMETRE_WITHIN: [&str; 8] =
    ["微米", "㎛", "1/1000 mm", "1/1000mm", "10^-3 mm", "10-3 mm", "10⁻³ mm", "0.001 mm"];
const INCH: [&str; 14] =
    list("inch|inches|ins|zoll|pulg|pulgada|pulgadas|pol|polegada|polegadas|pouce|pouces|pollici|duim");

pub(super) fn any(words: &[String], list: &[&str]) -> bool {
    words.iter().any(|word| list.contains(&word.as_str()))
}

fn within(words: &[String], list: &[&str]) -> bool {
    words.iter().any(|word| list.iter().any(|part| word.contains(part)))
}

pub(super) fn say_retained(words: &[String]) -> bool {
    any(words, &RETAINED) || within(words, &RETAINED_WITHIN)
}

pub(super) fn say_finer(words: &[String]) -> bool {
    any(words, &FINER) || within(words, &FINER_WITHIN)
}

pub(super) fn say_size(words: &[String]) -> bool {
    any(words, &SIZE) || within(words, &SIZE_WITHIN)
}

pub(super) fn say_cumulative(words: &[String]) -> bool {
    within(words, &CUMULATIVE_WITHIN)
}

pub(super) fn say_individual(words: &[String]) -> bool {
    within(words, &INDIVIDUAL_WITHIN)
}

pub(super) fn say_millimetres(words: &[String]) -> bool {
    any(words, &MILLIMETRE)
}

/// True if a name or its words mean micrometres rather than mm.
pub(super) fn say_micrometres(name: &str, words: &[String]) -> bool {
    let begins = |word: &String| MICROMETRES.iter().any(|stem| word.starts_with(stem));
    MICROMETRE_WITHIN.iter().any(|part| name.contains(part))
        || !say_millimetres(words) && (any(words, &MICROMETRE) || words.iter().any(begins))
}

pub(super) fn say_inches(words: &[String]) -> bool {
    any(words, &INCH)
}

pub(super) fn is_pan(text: &str) -> bool {
    PAN.contains(&text)
}

pub(super) fn is_total(text: &str) -> bool {
    TOTAL.contains(&text)
}
