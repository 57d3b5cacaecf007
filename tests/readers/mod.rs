//! What must hold of every reader, whatever bytes it is given: no panic, no endless loop, no more memory than
//! [`MOST_BYTES`], an error that can be shown, and what was read comes back from what is written of it.
//!
//! The fuzz targets and `tests/hostile_input.rs` both call these functions, so there is one definition.
#![allow(dead_code)]

use std::alloc::{GlobalAlloc, Layout, System};
use std::cell::RefCell;
use std::fmt::Display;
use std::io::{Read, Write};
use std::net::{Shutdown, TcpStream};
use std::path::Path;
use std::sync::OnceLock;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::time::Duration;

use bitvec::vec::BitVec;
use voidwalk::case::Case;
use voidwalk::cases::CasePlan;
use voidwalk::constrictions::{Curve, DEFAULT_MERGE_OVERLAP, VoidGraph};
use voidwalk::gradation::{Gradation, SizeSampler};
use voidwalk::network::{ArrayOptions, END, ExitRule, Flow, GraphShape, Network, NetworkColumns};
use voidwalk::packing::{CellOption, LengthUnit, Packing, ReadOptions};
use voidwalk::run::PrepareOptions;
use voidwalk::scene::{CurveSource, Scene};
use voidwalk::serve::{ServeOptions, Server};
use voidwalk::sheets::{Soil, SoilSummary, parse_gradation};
use voidwalk::store::checkpoint::{Checkpoint, Identity, Label, Section, save};
use voidwalk::walk::{Engine, RunPlan, SavedState, SizeClasses, State, Supply, Walk, WalkControl, WalkError};
use xxhash_rust::xxh3::xxh3_64;

/// The most memory that a process reading hostile input may hold (bytes).
pub const MOST_BYTES: usize = 256 << 20;

/// An error message that is longer does not tell a user anything (bytes).
const LONGEST_MESSAGE: usize = 20_000;

/// The system's allocator, which refuses to hand out more than [`MOST_BYTES`] in all.
pub struct Bounded;

static HELD: AtomicUsize = AtomicUsize::new(0);

// SAFETY: every call is handed on to the system's allocator unchanged, or answered with a null pointer, which
// says that there is no memory.
unsafe impl GlobalAlloc for Bounded {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        if HELD.fetch_add(layout.size(), Ordering::Relaxed) + layout.size() > MOST_BYTES {
            HELD.fetch_sub(layout.size(), Ordering::Relaxed);
            return std::ptr::null_mut();
        }
        // SAFETY: the caller's promise.
        unsafe { System.alloc(layout) }
    }

    unsafe fn dealloc(&self, ptr: *mut u8, layout: Layout) {
        HELD.fetch_sub(layout.size(), Ordering::Relaxed);
        // SAFETY: the caller's promise.
        unsafe { System.dealloc(ptr, layout) }
    }
}

/// What was read, or nothing once the error has been found fit to be shown.
fn shown<T, E: Display>(result: Result<T, E>) -> Option<T> {
    match result {
        Ok(value) => Some(value),
        Err(error) => {
            let message = error.to_string();
            assert!(!message.is_empty() && message.len() < LONGEST_MESSAGE, "{} bytes", message.len());
            None
        }
    }
}

/// A scene: reads, works out, and comes back from the scene that is kept with the results.
pub fn scene(bytes: &[u8]) {
    let Some(scene) = shown(Scene::parse(bytes, "scene.toml", &[])) else { return };
    // A lattice that is changed void by void is only built where that is quick; files are other readers'
    // matter.
    let voids =
        scene.network.source().shape().map(|lengths| lengths.iter().map(|&n| f64::from(n)).product::<f64>());
    let given = matches!(scene.filter.curve, Some(CurveSource::Shipped(_)));
    if !given || voids.is_none_or(|voids| voids > 60.0) || String::from_utf8_lossy(bytes).contains("sieve") {
        return;
    }
    let Some(case) = shown(Case::new(scene)) else { return };
    let text = case.resolved().to_toml();
    if case.inputs.is_empty() {
        let again =
            Scene::parse(text.as_bytes(), "resolved.toml", &[]).unwrap_or_else(|e| panic!("{text}: {e}"));
        let again = Case::new(again).unwrap_or_else(|e| panic!("{text}: {e}"));
        assert_eq!(again.resolved().to_toml(), text);
    }
}

/// A sieve table.
pub fn sieve(bytes: &[u8]) {
    for d0_mm in [None, Some(0.05)] {
        let Some(gradation) = shown(parse_gradation("sieve.csv", bytes, d0_mm)) else { continue };
        let points = gradation.points();
        assert!(
            points.windows(2).all(|pair| pair[0].size < pair[1].size && pair[0].percent <= pair[1].percent),
            "{points:?}"
        );
        for percent in [0.0, 15.0, 50.0, 85.0, 100.0] {
            let size = gradation.d(percent);
            assert!(size.is_none_or(|size| size.is_finite() && size > 0.0), "D{percent} = {size:?}");
        }
        if let Some(sampler) = shown(SizeSampler::new(&gradation, gradation.smallest_mm())) {
            for word in [0, 1, u64::MAX / 2, u64::MAX] {
                let size = sampler.diameter(word);
                assert!(size >= sampler.smallest() && size <= sampler.largest(), "{size}");
            }
        }
    }
}

/// A file of soils: text, workbook or AGS4.
pub fn soil(bytes: &[u8]) {
    for soil in shown(Soil::all("soils", bytes)).unwrap_or_default() {
        assert!(soil.name().len() < LONGEST_MESSAGE, "{} bytes", soil.name().len());
        shown(Soil::one("soils", bytes, Some(soil.name())));
        if let Some(summary) = shown(SoilSummary::of(&soil, None)) {
            assert!(
                summary.points.windows(2).all(|pair| pair[0].percent <= pair[1].percent),
                "{:?}",
                summary.points
            );
        }
    }
}

/// A constriction curve.
pub fn curve(bytes: &[u8]) {
    let Some(curve) = shown(Curve::from_csv_text("curve.csv", bytes)) else { return };
    for unit in [0.0, 0.3, 1.0] {
        let size = curve.quantile(unit);
        assert!(size >= curve.smallest() && size <= curve.largest(), "{size}");
    }
    shown(curve.in_mm(2.0));
}

/// A network: comes back from its own CSV bit for bit.
pub fn network(bytes: &[u8]) {
    let Some(network) = shown(Network::from_csv(bytes, "network.csv", 2.0)) else { return };
    let mut text = Vec::new();
    network.write_csv(&mut text).unwrap();
    assert_eq!(Network::from_csv(&text, "again.csv", 2.0).unwrap(), network);
}

/// A packing, of this program or of another: comes back from its own CSV bit for bit.
pub fn packing(bytes: &[u8]) {
    // What a file leaves open is said, so that files of every format are read.
    let options = ReadOptions { unit: Some(LengthUnit::Um), cell: Some(CellOption::None) };
    shown(Packing::parse_as("packing", bytes, &options));
    let Some(packing) = shown(Packing::parse("packing", bytes)) else { return };
    let again = Packing::parse("again", packing.to_csv().as_bytes()).unwrap();
    let bits = |p: &Packing| {
        [&p.x, &p.y, &p.z, &p.diameter].map(|c| c.iter().map(|v| v.to_bits()).collect::<Vec<_>>())
    };
    assert_eq!((again.cell, bits(&again)), (packing.cell, bits(&packing)));
}

/// Grains as the network of their own voids: measured or refused; water gets through without loss, or its flow is
/// refused.
pub fn graph(bytes: &[u8]) {
    let Some(packing) = shown(Packing::parse("packing", bytes)) else { return };
    // As many as are triangulated in milliseconds.
    if packing.diameter.len() > 64 {
        return;
    }
    let Some((curve, graph)) = shown(VoidGraph::measure(&packing, DEFAULT_MERGE_OVERLAP)) else { return };
    shown(curve.curve());
    let sizes = graph.diameter_mm.iter().chain(&graph.conductance_mm3).chain(&graph.volume_mm3);
    assert!(sizes.clone().all(|size| size.is_finite() && *size >= 0.0), "{:?}", sizes.collect::<Vec<_>>());
    for rule in [ExitRule::Flux, ExitRule::AreaAlongFlow, ExitRule::Height] {
        let shape = GraphShape { copies: 2, rule, rho: 0.01, unit_mm: graph.d0_mm };
        let Some(network) = shown(Network::of_graph(&graph, shape)) else { continue };
        flow(network, graph.conductance_mm3.iter().sum());
    }
}

/// A network given as columns, read from bytes.
pub fn columns(bytes: &[u8]) {
    let [voids, rule, ends @ ..] = bytes else { return };
    // Each constriction: two voids, a size and a conductance in one byte each, of which some are no numbers.
    let size = |byte: u8| match byte {
        0 => 0.0,
        255 => f64::NAN,
        254 => f64::INFINITY,
        253 => -1.0,
        252 => f64::MIN_POSITIVE,
        251 => 1e300,
        byte => 1.1f64.powi(i32::from(byte) - 128),
    };
    let rows: Vec<[u8; 4]> = ends.as_chunks::<4>().0.iter().take(200).copied().collect();
    let conns: Vec<[i64; 2]> =
        rows.iter().map(|row| [i64::from(row[0] as i8), i64::from(row[1] as i8)]).collect();
    let diameter_mm: Vec<f64> = rows.iter().map(|row| size(row[2])).collect();
    let conductance: Vec<f64> = rows.iter().map(|row| size(row[3])).collect();
    let outlets = [u32::from(*voids).saturating_sub(1)];
    for conductance in [None, Some(conductance.as_slice())] {
        let rule = [ExitRule::Area, ExitRule::Flux, ExitRule::AreaAlongFlow, ExitRule::Height]
            [usize::from(*rule % 4)];
        let columns = NetworkColumns {
            voids: usize::from(*voids),
            conns: &conns,
            diameter_mm: &diameter_mm,
            conductance,
            inlets: &[0],
            outlets: &outlets,
            rule,
            rho: 0.0,
            unit_mm: 1.0,
        };
        let Some((network, exits)) = shown(Network::from_columns(&columns)) else { continue };
        assert_eq!(exits.len(), conns.len());
        if rule == ExitRule::Area {
            let mut text = Vec::new();
            network.write_csv(&mut text).unwrap();
            assert!(!text.is_empty());
        } else {
            let all = conductance.unwrap_or(&[]).iter().sum::<f64>();
            flow(
                network,
                if conductance.is_some() { all } else { diameter_mm.iter().map(|d| d.powi(4)).sum() },
            );
        }
    }
}

/// A network of arrays in a zip: as it is, and with the sums of its parts made right, so that what they protect is
/// reached.
pub fn arrays(bytes: &[u8]) {
    for content in [bytes.to_vec(), with_right_zip_sums(bytes.to_vec())] {
        for rule in [ExitRule::Flux, ExitRule::Area] {
            let options = ArrayOptions { unit: LengthUnit::M, rule, rho: 0.01, unit_mm: 1.0 };
            let Some(network) = shown(Network::from_npz(&content, "net.npz", &options)) else { continue };
            assert!(network.voids() > 0 && network.constrictions() > 0);
            if rule == ExitRule::Area {
                network.write_csv(&mut Vec::new()).unwrap();
            }
        }
    }
}

/// The zip with the sum of each part that is stored as it is made right, as far as its table of contents can be
/// followed.
fn with_right_zip_sums(mut bytes: Vec<u8>) -> Vec<u8> {
    /// Of an entry of the table of contents, and of the header before a part.
    const ENTRY: (&[u8], usize) = (b"PK\x01\x02", 46);
    const PART: (&[u8], usize) = (b"PK\x03\x04", 30);
    let entries: Vec<usize> =
        (0..bytes.len().saturating_sub(ENTRY.1)).filter(|&at| bytes[at..].starts_with(ENTRY.0)).collect();
    for at in entries {
        let number = |at: usize, size: usize| -> usize {
            let all = bytes.get(at..at + size).unwrap_or(&[]);
            all.iter().rev().fold(0, |number, &byte| number << 8 | usize::from(byte))
        };
        let (method, length, part) = (number(at + 10, 2), number(at + 20, 4), number(at + 42, 4));
        let begin = part + PART.1 + number(part + 26, 2) + number(part + 28, 2);
        let is_part = bytes.get(part..).is_some_and(|rest| rest.starts_with(PART.0));
        let Some(data) = bytes.get(begin..begin + length).filter(|_| is_part && method == 0) else {
            continue;
        };
        let sum = crc32(data).to_le_bytes();
        bytes[at + 16..at + 20].copy_from_slice(&sum);
        bytes[part + 14..part + 18].copy_from_slice(&sum);
    }
    bytes
}

/// The sum of the parts of a zip (ISO 3309).
fn crc32(bytes: &[u8]) -> u32 {
    let byte = |sum: u32, &byte: &u8| {
        (0..8).fold(sum ^ u32::from(byte), |sum, _| sum >> 1 ^ (0xedb8_8320 & (sum & 1).wrapping_neg()))
    };
    !bytes.iter().fold(!0, byte)
}

/// Water through an undirected network, whose conductances have this sum: what goes in comes out, but for the residual
/// that a solution may leave.
fn flow(network: Network, conductances: f64) {
    let mut flow = Flow::new(&network);
    let open: BitVec = BitVec::repeat(false, network.constrictions());
    let Some(all) = shown(flow.solve(&network, &open)) else { return };
    assert!(all.conductance.is_finite() && all.conductance >= 0.0, "{all:?}");
    assert!(flow.pressure().iter().all(|p| p.is_finite()), "{:?}", flow.pressure());
    let Some(reservoir) = network.reservoir() else { return };
    let (mut inflow, mut outflow) = (0.0, 0.0);
    for void in 0..network.voids() as u32 {
        for exit in network.exits(void) {
            inflow += if void == reservoir { flow.flux(exit) } else { 0.0 };
            outflow += if network.targets()[exit] == END { flow.flux(exit) } else { 0.0 };
        }
    }
    // Where conductances lie so far apart that rounding leaves more than that, no water is said to flow.
    let part = if all.conductance > 0.0 { 1e-9 } else { 1e-6 };
    let residual = part * conductances * network.voids() as f64;
    assert!((inflow - outflow).abs() <= 1e-6 * inflow.abs() + residual, "{inflow} in, {outflow} out");
    let mut network = network;
    flow.direct(&mut network);
    assert!((0..network.constrictions()).all(|exit| network.exit_weight(exit) >= 0.0));
}

/// A checkpoint: as it is, and with its checksums made right, so that what they protect is reached.
pub fn checkpoint(bytes: &[u8]) {
    for content in [bytes.to_vec(), with_right_sums(bytes.to_vec())] {
        let Some(saved) = shown(Checkpoint::parse("x.0", content)) else { continue };
        if shown(saved.check()).is_none() {
            continue;
        }
        SMALL_RUNS.with_borrow(|runs| {
            for run in runs {
                let mut state = run.fresh();
                shown(state.restore(&run.network, &run.supply, &saved));
            }
        });
        for name in ["counts", "history_increment", "blocked"] {
            shown(saved.read::<u64>(name));
        }
        shown(saved.read::<u8>("done"));
    }
}

/// A plan, and the ledger of a campaign: the first line is `campaign.json`, the others are `ledger.jsonl`.
pub fn ledger(bytes: &[u8]) {
    // The cross of many factors takes its time and is bounded by itself.
    if bytes.len() < 2000
        && let Some(plan) = shown(CasePlan::parse(bytes, Path::new("plan.toml")))
    {
        for case in &plan.cases {
            let name = case.folder_name();
            assert!(!name.contains('/') && !name.starts_with('.') && name.len() < 200, "{name}");
        }
    }
    let Ok(text) = std::str::from_utf8(bytes) else { return };
    let (about, lines) = text.split_once('\n').unwrap_or((text, ""));
    if let Some(page) = shown(voidwalk::report::campaign_page(about, lines)) {
        assert!(!page.to_lowercase().contains("<script"), "a script got into the page");
    }
}

/// A request to the page on this machine, in which `{A}` stands for its address with the secret, and `{H}` for its
/// name: it is answered, or the connection ends; and nobody is let in, or told the secret, who does not know it. What
/// would walk is left out by name.
pub fn request(bytes: &[u8]) {
    static ADDRESS: OnceLock<String> = OnceLock::new();
    let address = ADDRESS.get_or_init(page);
    let (host, secret) = address.trim_matches('/').split_once('/').unwrap();
    let text = String::from_utf8_lossy(bytes);
    if ["check", "judge", "batch", "continue"].iter().any(|work| text.contains(work)) {
        return;
    }
    let sent = text.replace("{A}", &format!("/{secret}/")).replace("{H}", host);
    let mut stream = TcpStream::connect(host).expect("the page answers");
    stream.set_read_timeout(Some(Duration::from_secs(30))).unwrap();
    // A page that refuses what is sent may end the connection before all of it has gone.
    let _ = stream.write_all(sent.as_bytes());
    let _ = stream.shutdown(Shutdown::Write);
    let mut answer = Vec::new();
    let _ = stream.read_to_end(&mut answer);
    if answer.is_empty() {
        return;
    }
    let answer = String::from_utf8_lossy(&answer);
    let status = answer.strip_prefix("HTTP/1.1 ").and_then(|rest| rest.get(..3)?.parse::<u16>().ok());
    let status = status.unwrap_or_else(|| panic!("no answer to HTTP: {answer}"));
    assert!((100..600).contains(&status), "{answer}");
    if !sent.contains(secret) {
        assert!(status >= 400, "let in: {answer}");
        assert!(!answer.contains(secret), "told the secret: {answer}");
    }
}

/// A page that answers and never walks; its address without `http:/`. It ends with the process.
fn page() -> String {
    let folder = option_env!("CARGO_TARGET_TMPDIR").map_or_else(std::env::temp_dir, Into::into);
    let folder = folder.join(format!("requests-{}", std::process::id()));
    let options = ServeOptions {
        port: 0,
        folder: Some(folder),
        prepare: PrepareOptions::default(),
        on_results: |_, _, _| Ok(()),
        command: "voidwalk serve".into(),
    };
    let server = Server::open(options).unwrap();
    let address = server.address().trim_start_matches("http:/").to_owned();
    // Jobs are over at once; connections are answered on.
    server.run(&AtomicBool::new(true)).unwrap();
    address
}

/// A run of a lattice that is made in microseconds.
pub struct SmallRun {
    /// Its network.
    pub network: Network,
    /// What it inserts.
    pub supply: Supply,
    open: BitVec,
}

thread_local! {
    static SMALL_RUNS: RefCell<Vec<SmallRun>> =
        RefCell::new([Engine::Particles, Engine::Counts, Engine::Expected].map(SmallRun::new).into());
}

impl SmallRun {
    /// The run walked by this engine.
    pub fn new(engine: Engine) -> Self {
        let curve = voidwalk::constrictions::find("shire2016-cu1.5-loose").unwrap().curve().unwrap();
        let network = Network::cubic([2, 2, 3], &curve.in_mm(1.0).unwrap(), 1.0, 4).unwrap();
        let gradation = Gradation::linear_from_dx(85.0, 0.45, 3.0).unwrap();
        let open: BitVec = BitVec::repeat(false, network.constrictions());
        let sampler = SizeSampler::new(&gradation, 1.0).unwrap();
        let plan = RunPlan::new(engine, &network, &sampler, &open, 20);
        let supply = plan.supply(sampler, 2000, 100, 11, 1);
        Self { network, supply, open }
    }

    /// Its state before the first increment.
    pub fn fresh(&self) -> State {
        let classes = SizeClasses::logarithmic(0.1, 0.6, 4);
        State::new(&self.network, &self.supply, classes, self.open.clone(), 11, 1)
    }

    /// What its checkpoints are of.
    pub fn identity() -> Identity {
        Identity { scene: "small".into(), part: 0, replicate: 1, seed: 11, n_base: 2000 }
    }

    /// Walks on from `state`, and saves it in `folder` once, after this increment.
    pub fn walk(&self, state: &mut State, kept: Option<(&Path, u64)>) {
        let done = br#"{"complete":false}"#;
        let result = self.walk_while(state, |state| {
            if let Some((folder, increment)) = kept
                && state.increment == increment
            {
                let identity = SmallRun::identity();
                let label = Label { identity, network: 0, run: 1, increment, generation: 2 };
                let saved = SavedState::new(state);
                let mut sections = saved.sections();
                sections.push(Section::new("done", done));
                save(folder, "x", &label, &sections).unwrap();
            }
            WalkControl::Continue
        });
        result.unwrap();
    }

    /// Walks on from `state` until its end or until `observe` stops it.
    pub fn walk_while(
        &self,
        state: &mut State,
        mut observe: impl FnMut(&State) -> WalkControl + Send,
    ) -> Result<(), WalkError> {
        Walk::new(&self.network, &self.supply, state).run(state, &mut observe)
    }
}

/// The file with its length, the sums of its pieces and that of its header made right, as far as it has room
/// for them.
pub fn with_right_sums(mut bytes: Vec<u8>) -> Vec<u8> {
    /// Bytes of a piece, of the fixed fields of a header and of a row of its table; where the number of
    /// sections is.
    const PIECE: usize = 1 << 20;
    const FIXED: usize = 160;
    const ROW: usize = 56;
    const NUMBER: usize = 128;
    let word = |bytes: &[u8], at: usize| -> usize {
        bytes.get(at..at + 8).map_or(0, |w| u64::from_le_bytes(w.try_into().unwrap()) as usize)
    };
    let (length, header) = (bytes.len(), word(&bytes, 16));
    if header < FIXED + 8 || header > length {
        return bytes;
    }
    bytes[24..32].copy_from_slice(&(length as u64).to_le_bytes());
    let mut sum_at = FIXED + ROW * word(&bytes, NUMBER).min(64);
    for section in 0..word(&bytes, NUMBER).min(64) {
        let at = FIXED + ROW * section;
        let Some(element) = bytes.get(at + 32..at + 36) else { break };
        let element = u32::from_le_bytes(element.try_into().unwrap()) as usize;
        let (count, offset) = (word(&bytes, at + 40), word(&bytes, at + 48));
        let Some(size) = count.checked_mul(element).filter(|size| *size <= length) else { break };
        let Some(data) = offset.checked_add(size).and_then(|end| bytes.get(offset..end)) else { break };
        let sums: Vec<u8> = data.chunks(PIECE).flat_map(|piece| xxh3_64(piece).to_le_bytes()).collect();
        let Some(place) =
            bytes.get_mut(sum_at..sum_at + sums.len()).filter(|_| sum_at + sums.len() <= header - 8)
        else {
            break;
        };
        place.copy_from_slice(&sums);
        sum_at += sums.len();
    }
    let sum = xxh3_64(&bytes[..header - 8]);
    bytes[header - 8..header].copy_from_slice(&sum.to_le_bytes());
    bytes
}
