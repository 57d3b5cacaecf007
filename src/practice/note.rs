//! Notes on an answer: a table of all notes with their numbers and sentences.
//!
//! A row makes a variant of [`Note`]. A name ending in `_mm`, `_percent` or `_pp` (percentage points) has
//! that unit. A name beginning with `least_` or `most_` is a minimum or maximum, one with `over_` a lower
//! bound, and a whole number is a count: `{n:replicate}` and `{n:copy|copies}` give it its noun. No sentence
//! depends on another note. Only faces fill in the sentences and read them.

use serde::{Deserialize, Serialize};

/// Row of a note in the table.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Entry {
    /// Subject in one or two words.
    pub label: &'static str,
    /// Page of `src/docs` that explains the note.
    pub page: &'static str,
    /// Sentence with the names of its numbers in braces.
    pub sentence: &'static str,
    /// Setting that changes the note; empty without one.
    pub setting: &'static str,
}

/// Several names in a note.
type NameList = Vec<String>;

/// A note as files have it. One form for all notes compiles in a tenth of the time that one for each takes.
#[derive(Serialize, Deserialize)]
struct Record {
    id: String,
    numbers: serde_json::Map<String, serde_json::Value>,
}

impl Record {
    /// Takes out the number of this name.
    fn take<T: serde::de::DeserializeOwned>(&mut self, name: &str) -> Result<T, String> {
        let value = self.numbers.remove(name).unwrap_or_default();
        serde_json::from_value(value).map_err(|error| format!("{name} of note {}: {error}", self.id))
    }
}

fn value(number: impl Serialize) -> serde_json::Value {
    serde_json::to_value(number).expect("numbers and words")
}

/// Letters of the name in a file of a variant with this name.
fn snake_case(variant: &str) -> impl Iterator<Item = char> {
    variant.char_indices().flat_map(|(place, letter)| {
        let before = (place > 0 && letter.is_ascii_uppercase()).then_some('_');
        before.into_iter().chain([letter.to_ascii_lowercase()])
    })
}

macro_rules! notes {
    (@setting) => { "" };
    (@setting $setting:literal) => { $setting };
    (@any f64 $number:ident $count:ident $text:ident) => { $number };
    (@any u64 $number:ident $count:ident $text:ident) => { $count };
    (@any String $number:ident $count:ident $text:ident) => { $text.to_owned() };
    (@any NameList $number:ident $count:ident $text:ident) => { vec![$text.to_owned(); 2] };
    ($(
        $name:ident { $($number:ident: $kind:ident),* $(,)? }
            $label:literal $page:literal $sentence:literal $($setting:literal)?;
    )*) => {
        /// A note with its numbers, in the order of every face.
        #[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
        #[cfg_attr(feature = "schemas", derive(schemars::JsonSchema), schemars(with = "schema::Note"))]
        #[serde(into = "Record", try_from = "Record")]
        pub enum Note {
            $(#[doc = $sentence] $name {
                $(#[allow(missing_docs)] $number: $kind),*
            },)*
        }

        impl Note {
            /// Row of the note in the table.
            pub fn entry(&self) -> Entry {
                match self {
                    $(Self::$name { .. } => Entry {
                        label: $label,
                        page: $page,
                        sentence: $sentence,
                        setting: notes!(@setting $($setting)?),
                    },)*
                }
            }

            /// Index of the note in the table.
            pub fn place(&self) -> usize {
                #[allow(clippy::enum_variant_names)]
                enum Place { $($name,)* }
                match self {
                    $(Self::$name { .. } => Place::$name as usize,)*
                }
            }

            /// True if the note says that a table may not be the intended one.
            pub fn is_of_a_mistake(&self) -> bool {
                matches!(
                    self,
                    Self::UnitDoubtful { .. } | Self::FilesExchanged { .. } | Self::FilterOfBoulders { .. }
                )
            }

            /// Name of the note in a file.
            pub fn id(&self) -> String {
                match self {
                    $(Self::$name { .. } => snake_case(stringify!($name)).collect(),)*
                }
            }

            /// Every note with this number, count and text, for tests of a face.
            #[doc(hidden)]
            pub fn all_with(number: f64, count: u64, text: &str) -> Vec<Self> {
                vec![$(Self::$name { $($number: notes!(@any $kind number count text)),* }),*]
            }
        }

        impl From<Note> for Record {
            fn from(note: Note) -> Self {
                let id = note.id();
                let numbers = match note {
                    $(Note::$name { $($number),* } => vec![$((stringify!($number), value($number))),*],)*
                };
                let numbers = numbers.into_iter().map(|(name, value)| (name.to_owned(), value)).collect();
                Self { id, numbers }
            }
        }

        impl TryFrom<Record> for Note {
            type Error = String;

            fn try_from(mut record: Record) -> Result<Self, String> {
                $(if record.id.chars().eq(snake_case(stringify!($name))) {
                    return Ok(Self::$name { $($number: record.take(stringify!($number))?),* });
                })*
                Err(format!("unknown note {:?}", record.id))
            }
        }

        #[cfg(feature = "schemas")]
        mod schema {
            /// A note with its numbers.
            #[derive(schemars::JsonSchema)]
            #[allow(dead_code)]
            pub(super) struct Note {
                /// Its name.
                id: NoteId,
                /// Its numbers by name, with the unit in the name.
                numbers: serde_json::Map<String, serde_json::Value>,
            }

            /// The name of a note.
            #[derive(schemars::JsonSchema)]
            #[schemars(rename_all = "snake_case")]
            #[allow(dead_code)]
            enum NoteId { $($name,)* }
        }
    };
}

notes! {
    // Uncertainty left by the replicates.
    ReplicatesLeaveOpen {} "replicates" "uncertainty.md"
        "The replicates do not separate the classes."
        "--decide-percent 99 adds replicates until the class is that certain.";
    SecondRunMissing {} "second run" "uncertainty.md"
        "Some and continuing erosion differ by the second run, and only a first was asked for."
        "runs = 2 walks both.";
    LevelMissed { level_percent: f64, run: u64, distance_pp: f64 } "level" "uncertainty.md"
        "The class is open at the {level_percent} confidence level: the mean of run {run} lies \
         {distance_pp} from 7.5 %.";

    // Results of practice besides retention.
    LosesFines { authorities: NameList } "internal stability" "rules.md"
        "The filter may lose its finer part by {authorities}.";
    TooFineToDrain { least_d15f_mm: f64 } "drainage" "rules.md"
        "The filter may be too fine to drain the base: practice asks for a D15F of at least {least_d15f_mm}.";
    FinesOfFilter { most_fines_percent: f64 } "drainage" "rules.md"
        "The filter has fines and may not drain: practice allows at most {most_fines_percent} finer than \
         0.075 mm.";
    MaySegregate { quantities: NameList } "segregation" "rules.md"
        "The filter may segregate when it is placed ({quantities}).";
    DispersionNotKnown { most_d15f_mm: f64 } "dispersion" "rules.md"
        "Whether the base is dispersive is not stated; if it is, D15F must be at most {most_d15f_mm}."
        "Say so once a test has shown it: --dispersive, or --set base.dispersive=false if it is not.";
    DispersiveLimitNotKnown { most_d15f_mm: f64 } "dispersion" "rules.md"
        "Whether the base is dispersive is not stated; if it is, D15F must be less than {most_d15f_mm}, and \
         only a test tells how much."
        "Say so once a test has shown it: --dispersive, or --set base.dispersive=false if it is not.";
    LimitWithoutMargin { most_d15f_mm: f64 } "margin" "rules.md"
        "The limit of D15F itself, {most_d15f_mm}, has no margin: it is not below the boundary of no erosion \
         of tests.";
    UnstableBase { index: f64, finer_percent: f64 } "base stability" "rules.md"
        "The base is internally unstable by Kenney and Lau (H/F {index} at {finer_percent} finer): decide \
         whether the filter is to hold its finer part.";

    // Search for a boundary.
    LayerThicker { ratio: f64, layer_mm: f64, thickness: String } "thickness" "boundary.md"
        "At D15F/D85B {ratio} one layer of voids is {layer_mm} thick; a filter of {thickness} holds less.";
    Unsteady { networks_held: u64, networks_eroding: u64 } "scatter" "boundary.md"
        "The boundary is noisy: {networks_held} of the {networks_eroding} eroding networks held at a larger \
         D15F/D85B than one that failed.";
    NothingWalked {} "search" "boundary.md"
        "No D15F/D85B of the search could be walked.";
    ErodesEverywhere { networks_eroding: u64, networks: u64 } "search" "boundary.md"
        "{networks_eroding} of {networks:network} erode 7.5 % or more at every ratio of the search.";
    HoldsEverywhere { ratio: f64 } "search" "boundary.md"
        "Nearly all networks hold to D15F/D85B {ratio}, where the search ends; the boundary is not known.";
    MedianBeyond { ratio: f64, networks_eroding: u64, networks: u64 } "search" "boundary.md"
        "{networks_eroding} of {networks:network} erode up to D15F/D85B {ratio}, where the search ends; the \
         median lies beyond it.";
    ErodesToEnd { ratio: f64, networks: u64 } "search" "boundary.md"
        "At least 7.5 % of the base erodes down to D15F/D85B {ratio}, where the search ends \
         ({networks:network}).";
    ErodesTo { ratio: f64, networks: u64, reason: String } "search" "boundary.md"
        "At least 7.5 % of the base erodes down to D15F/D85B {ratio} ({networks:network}); smaller ratios: \
         {reason}.";
    HoldsToEnd { run: u64, ratio: f64, networks: u64 } "search" "boundary.md"
        "Less than 7.5 % erodes in run {run} up to D15F/D85B {ratio}, where the search ends \
         ({networks:network}).";
    NotWalked { networks: u64, reason: String } "search" "boundary.md"
        "The search could go no further ({networks:network}): {reason}.";
    SparedEnd { density: String, ratio: f64 } "search" "boundary.md"
        "The end {density} holds clearly more (D15F/D85B {ratio} on its first network); its boundary was \
         not searched.";
    PanErodes { finest_percent: f64 } "below the last sieve" "boundary.md"
        "{finest_percent} of the base is finer than its finest sieve, which is enough to count as erosion."
        "Finer sieves would tell, or base.d0_mm.";

    // Results of walks.
    DecidedBelow95 { level_percent: f64 } "level" "uncertainty.md"
        "The class is decided at the {level_percent} confidence level, as asked; at 95 % these replicates \
         leave it open.";
    CloggedBefore { replicates: u64, walked: u64, smaller_inject_share: f64 } "clogging" "uncertainty.md"
        "No water flows in the second run in {replicates} of {walked:replicate}: what was on its way counts \
         as retained."
        "Try inject_share = {smaller_inject_share}.";
    Clogged {
        run: u64, replicates: u64, walked: u64, over_on_its_way_percent: f64, smaller_inject_share: f64,
    }
        "clogging" "uncertainty.md"
        "The filter clogged in run {run} in {replicates} of {walked:replicate}; at least \
         {over_on_its_way_percent} of the base, on its way then, counts as retained."
        "Try inject_share = {smaller_inject_share}.";
    TrappedCouldTurn { trapped: u64, inserted: u64, mass_percent: f64 } "trapped" "uncertainty.md"
        "{trapped} of {inserted} particles, up to {mass_percent} of the base, are trapped in closed loops \
         and could change the class.";
    SecondRunErodes { eroded_percent: f64 } "second run" "uncertainty.md"
        "The second run erodes {eroded_percent} of its base, though the first erodes less than 7.5 %.";

    SecondRunMayErode { most_percent: f64 } "second run" "uncertainty.md"
        "The second run may erode up to {most_percent} of its base, though the first erodes less than 7.5 %.";

    // Inputs.
    CoarseBase { d85_mm: f64 } "unit" "soils.md"
        "The D85 of the base is {d85_mm}: are its sizes micrometres under a header in mm?";
    CohesiveFines { fines_percent: f64 } "fines" "soils.md"
        "The base has {fines_percent} fines (finer than 0.075 mm), and the model ignores cohesion.";
    FinesNotSieved { fines_percent: f64, sieve_mm: f64 } "fines" "soils.md"
        "Up to {fines_percent} of the base, finer than its last sieve ({sieve_mm}), may be fines; the model \
         ignores cohesion.";
    NotRegraded { sieve_mm: f64 } "unsafe side" "soils.md"
        "The model errs on the unsafe side: practice regrades this base on {sieve_mm}, and it is walked as \
         sampled."
        "base.regrade = \"practice\" walks the part that practice looks at.";
    BroadlyGraded { cu: f64 } "unsafe side" "soils.md"
        "The model errs on the unsafe side for a broadly graded base (Cu {cu}): a few coarse grains block \
         for the rest.";
    NotStudied {} "not studied" "uncertainty.md"
        "How the class changes with the amount of base and the thickness of the filter was not studied."
        "record.sensitivity and record.thickness study it.";
    DispersiveBase {} "dispersion" "rules.md"
        "The base is dispersive; the model knows its sizes alone.";
    OpenJoint { width_mm: f64 } "joint" "rules.md"
        "An open joint of {width_mm} was not walked; the rules say how likely erosion continues into it.";
    ThicknessWithoutUnit { real_mm: f64, unit: String } "thickness" "uncertainty.md"
        "The real filter is {real_mm} thick, and sizes are multiples of {unit}: the two cannot be compared."
        "Give sizes in mm, or leave filter.thickness_mm out.";
    ThicknessOfFile { real_mm: f64 } "thickness" "uncertainty.md"
        "The thickness of a network from a file is not known; the real filter is {real_mm} thick.";
    LayersThicker { layers: u64, modelled_mm: f64, real_mm: f64 } "thickness" "uncertainty.md"
        "The modelled filter ({layers:layer}, {modelled_mm}) is thicker than the real one ({real_mm}) and \
         retains more."
        "network.nz says how many layers.";
    CopiesThicker { copies: u64, modelled_mm: f64, real_mm: f64 } "thickness" "uncertainty.md"
        "The modelled filter ({copies:copy|copies} of the packing, {modelled_mm}) is thicker than the real \
         one ({real_mm}) and retains more."
        "network.copies, or network.thickness_mm, rounded up to whole copies, says how thick it is.";
    ThinnerThanGrain { modelled_mm: f64, grain_mm: f64 } "thickness" "uncertainty.md"
        "The model is {modelled_mm} of the filter, less than its largest grain ({grain_mm}).";
    CappedBase { particles: u64, needed: u64 } "amount of base" "uncertainty.md"
        "The base is capped at {particles} of {needed} particles; offered too few, a filter can seem to hold."
        "base.cap is the cap.";
    FewParticles { particles: u64, needed: u64 } "amount of base" "uncertainty.md"
        "The base has {particles} of the {needed} particles of Eq. (2); offered too few, a filter can seem \
         to hold.";
    MoreParticles { particles: u64, needed: u64 } "amount of base" "uncertainty.md"
        "The base has {particles} particles for the {needed} of Eq. (2); with more base a smaller fraction \
         passes, so a filter can seem to hold.";
    LowMassRatio { ratio_percent: f64 } "amount of base" "uncertainty.md"
        "The mass of the base is {ratio_percent} of the filter's instead of 5 %; offered too few, a filter \
         can seem to hold."
        "base.mass_ratio says how much.";
    AmountUnknown { particles: u64 } "amount of base" "uncertainty.md"
        "Whether {particles} base particles are enough is not known: the grains per void of the filter are \
         not given."
        "filter.grains_per_void says how many grains the filter has for each void.";
    AmountHeld { particles: u64 } "amount of base" "boundary.md"
        "At most {particles} base particles are walked at every ratio; where more are needed, filters can \
         seem to hold."
        "base.n_base and base.cap hold it.";
    GivenNetwork { voids: u64 } "network" "graph.md"
        "The network was given, with {voids:void}; nothing of it was checked against tests.";
    NoFilter {} "filter" "rules.md"
        "The filter was not given, so no rule of practice was applied.";
    NarrowLattice { nx: u64, ny: u64 } "network" "uncertainty.md"
        "The lattice is only {nx} x {ny} voids across and can seal by chance; use 10 x 10 or more, better \
         40 x 40.";
    AllOnItsWay { increments: u64, layers: u64 } "increments" "uncertainty.md"
        "The whole base is inserted in {increments:increment} before any is through {layers:layer}; what is \
         on its way when water stops counts as retained."
        "A smaller inject_share makes more increments.";
    CuUnchecked { soil: String, cu: f64, low: f64, high: f64 } "uniformity" "soils.md"
        "The Cu of the {soil} is {cu}, and the model was checked for {low} to {high}.";
    CuAtLeast { soil: String, over_cu: f64, d10_mm: f64, low: f64, high: f64 } "uniformity" "soils.md"
        "The Cu of the {soil} is more than {over_cu} (D10 is finer than {d10_mm}), and the model was checked \
         for {low} to {high}.";
    CuUnknown { soil: String, low: f64, high: f64 } "uniformity" "soils.md"
        "The D10, and so the Cu, of the {soil} is not known; the model was checked for a Cu of {low} to \
         {high}.";
    GapGraded { within_percent: f64, from_mm: f64 } "gap" "soils.md"
        "The filter is gap-graded: only {within_percent} lies between {from_mm} and four times that; its \
         finer part, which it may lose, was walked.";
    OtherCurve { cu: f64, curve: String, curve_cu: f64 } "constrictions" "uncertainty.md"
        "The filter has a Cu of {cu}, but is walked with the constrictions of one of {curve_cu} ({curve}).";
    LibraryOfAnyDensity { error_percent: f64, grains_percent: f64 } "density" "uncertainty.md"
        "The density is not given: similar packings, loose to dense, are walked with errors of \
         {error_percent} (constrictions) and {grains_percent} (grains per void)."
        "filter.library says how densely it lies; filter.density packs this very filter.";
    LibraryOfDensity { density: String, error_percent: f64, grains_percent: f64 }
        "not packed" "uncertainty.md"
        "Similar packings ({density}) give constrictions within {error_percent}, grains per void within \
         {grains_percent}; both ends are walked, the coarser with fewest grains."
        "filter.density packs this very filter.";
    LikeNoneOfTheLibrary {} "constrictions" "uncertainty.md"
        "No packing of the library is like this filter, so its constrictions are guessed."
        "filter.density packs it.";
    GuessedConstrictions {} "constrictions" "uncertainty.md"
        "The constrictions are a guess, 0.65 to 1.9 times the median that was measured on packed filters; \
         both ends are walked."
        "filter.density packs the grains and measures it, of a broad filter on its finer part.";
    GuessedGrains { grains: f64 } "amount of base" "uncertainty.md"
        "The grains per void, {grains}, are a guess (0.43 to 0.69 were measured); the amount of base \
         follows from them."
        "filter.grains_per_void gives it.";
    PartPacked { part_percent: f64, largest_mm: f64, finer_percent: f64 } "packed part" "uncertainty.md"
        "Only the finer {part_percent} (up to {largest_mm}) was packed; its constrictions may be \
         {finer_percent} too fine, and both ends are walked.";
    FloatingPartPacked { part_percent: f64, largest_mm: f64, finer_percent: f64 } "packed part"
        "uncertainty.md"
        "Only the finer {part_percent} (up to {largest_mm}) was packed, {finer_percent} finer at most; the \
         coarse grains are taken to float in it.";
    LoosePartPacked { part_percent: f64, largest_mm: f64, finer_percent: f64 } "packed part" "uncertainty.md"
        "Only the finer {part_percent} (up to {largest_mm}) was packed, {finer_percent} finer at most; it \
         may lie loose, with wider constrictions open.";
    Skeleton { loose_percent: f64 } "loose grains" "uncertainty.md"
        "The coarse grains carry each other, and {loose_percent} of all grains lie loose: water may wash out \
         the constrictions that were walked.";
    OneReplicate {} "replicates" "uncertainty.md"
        "There is one replicate, so the scatter is unknown."
        "replicates = 10, say.";
    FewReplicates { replicates: u64 } "replicates" "uncertainty.md"
        "There are only {replicates:replicate}, whose scatter is hardly known."
        "replicates = 10, say.";
    FewNetworks { networks: u64 } "networks" "boundary.md"
        "The search has only {networks:network}; a range of 5 to 95 % needs 5 at least, better 20."
        "--set replicates=20.";

    // Further facts.
    PanPassive { finest_percent: f64 } "below the last sieve" "soils.md"
        "{finest_percent} of the base is finer than its last sieve and than every constriction; it counts \
         by mass only.";
    PanCountsAsPassing { finest_percent: f64, sieve_mm: f64, constriction_mm: f64 }
        "below the last sieve" "soils.md"
        "The finest {finest_percent} of the base lies below its last sieve, {sieve_mm}, and counts as \
         passing; the finest constriction is {constriction_mm}.";
    Arches { law: String } "arches" "arches.md"
        "Particles jam together in constrictions that each would pass, by a law ({law}) that no filter test \
         has checked.";
    Openings {} "openings" "arches.md"
        "A blocked constriction stays open beside the particle that blocks it; no filter test has checked \
         how wide.";
    CurveRange {} "constrictions" "uncertainty.md"
        "Every constriction curve that was walked gives this class; the eroded mass covers all of them."
        "A filter that is packed whole (filter.density) has one measured curve.";
    CurveDecides { of_the_curve: String } "constrictions" "uncertainty.md"
        "The class depends on where the filter lies within the range that was walked: its likeliest \
         constrictions give {of_the_curve}."
        "A filter that is packed whole (filter.density) has one measured curve.";
    UnitDoubtful { base_d50_mm: f64, filter_d50_mm: f64 } "tables" "soils.md"
        "The base (D50 {base_d50_mm}) is far coarser than the filter (D50 {filter_d50_mm}): are sizes \
         micrometres, or the files exchanged?";
    FilesExchanged { base_d15_mm: f64, filter_d15_mm: f64 } "tables" "soils.md"
        "The base is coarser than the filter (D15 {base_d15_mm} against {filter_d15_mm}): are the files \
         exchanged, or its sizes micrometres?";
    FilterOfBoulders { d50_mm: f64 } "tables" "soils.md"
        "The filter's D50 is {d50_mm}: are its sizes micrometres under a header in mm?";
    UnstableSide { side: String, authorities: NameList } "stability of the band" "design.md"
        "The {side} side of the band is not internally stable by {authorities}: judge each delivery by its \
         own gradation.";
    BroadBase { cu: f64 } "grading of the base" "design.md"
        "The base is broadly graded (Cu {cu} as sampled): its finer part may move between its coarse grains.";
    BroadBaseAtLeast { over_cu: f64 } "grading of the base" "design.md"
        "The base is broadly graded (Cu above {over_cu} as sampled): its finer part may move between its \
         coarse grains.";
    GapOfBase { within_percent: f64, from_mm: f64, to_mm: f64 } "gap of the base" "design.md"
        "The base is gap-graded by the program's check: only {within_percent} lies between {from_mm} and \
         {to_mm}. Look at the curve.";
    FlatBase { from_mm: f64, to_mm: f64, within_percent: f64 } "gap of the base" "design.md"
        "The curve of the base is flat: {within_percent} lies between {from_mm} and {to_mm}. Whether that is \
         a gap is left to judgement.";
    TargetMissed { target_pp: f64, half_width_pp: f64, replicates: u64, needed: u64 } "target error"
        "uncertainty.md"
        "After {replicates:replicate} the error is {half_width_pp}, not {target_pp}; about {needed} would \
         do.";
    Regraded { part_percent: f64, sieve_mm: f64 } "grading" "soils.md"
        "The base is walked as practice regrades it: the {part_percent} of it that is finer than {sieve_mm}.";
    RegradingNotNeeded {} "grading" "soils.md"
        "The base was to be regraded, and is walked as sampled: practice does not regrade it, or its sizes \
         do not tell.";
    ReadAs { file: String, reading: String } "file" "soils.md"
        "{file}: {reading}.";
    Envelope { soil: String, curves: NameList } "envelope" "rules.md"
        "The {soil} is taken as the envelope of its curves ({curves})."
        "FILE#NAME takes one of them.";
    PanOfFilter { finest_percent: f64 } "finest part" "soils.md"
        "The finest {finest_percent} of the filter is not counted: more base is offered, and a filter can \
         seem to hold."
        "filter.d0_mm says where that part ends.";
    LooseGrains { loose_percent: f64 } "loose grains" "uncertainty.md"
        "{loose_percent} of the filter's grains lie loose between the others; water may move them, and the \
         model does not.";
    NarrowCell { grains: u64, aspect: f64, width: f64, usual: f64 } "cell" "uncertainty.md"
        "The packed cell of {grains:grain}, {aspect} times as tall as wide, is {width} times as wide as the \
         largest grain ({usual} is usual)."
        "packing.grains says how many grains.";
    OneNetwork {} "network" "graph.md"
        "All replicates walk one network; their spread says nothing of other networks of the filter.";
    OnePacking { copies: u64 } "packing" "graph.md"
        "All replicates walk the voids of one packing ({copies:copy|equal copies}); their spread leaves out \
         that between packings.";
    LongWayOut { moves: f64 } "loops" "graph.md"
        "A particle that nothing stops makes {moves} moves in loops with narrow ways out; the walk may not \
         end."
        "Give those ways out a diameter of 0, so that what circles counts as trapped, or a wider one.";
    NotMonotone { networks: u64 } "search" "boundary.md"
        "On {networks:network} a larger ratio held than one that eroded; the smallest that eroded counts.";
    Trapped { particles: u64 } "trapped" "uncertainty.md"
        "{particles:particle} trapped in closed loops; they count as retained.";
    Permeability { run: u64, left_percent: f64 } "permeability" "graph.md"
        "At the end of run {run} the permeability is {left_percent} of the clean filter's.";
    Overfull { fullest: f64, voids_percent: f64 } "full voids" "graph.md"
        "Up to {voids_percent} of the voids hold more than there is room for (the fullest {fullest} times \
         its volume).";
    NoRoom { voids_percent: f64 } "full voids" "graph.md"
        "Particles rest in up to {voids_percent} of the voids that have no volume between the grains.";
}

/// The notes of a case, each once, in the order of their table.
pub fn ordered(notes: impl IntoIterator<Item = Note>) -> Vec<Note> {
    let mut all: Vec<Note> = Vec::new();
    for note in notes {
        if !all.contains(&note) {
            all.push(note);
        }
    }
    all.sort_by_key(Note::place);
    all
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn notes_stand_in_the_order_of_the_table_whatever_the_order_in_which_they_came() {
        let table = [
            Note::ReplicatesLeaveOpen {},
            Note::CohesiveFines { fines_percent: 35.0 },
            Note::PanOfFilter { finest_percent: 2.0 },
        ];
        let mut all = vec![table[2].clone(), table[1].clone(), table[0].clone(), table[1].clone()];
        for _ in 0..all.len() {
            all.rotate_left(1);
            assert_eq!(ordered(all.clone()), table);
        }
    }
}
