#!/usr/bin/env python3
"""Plants one bug after another in a copy of the sources and sees that a named test fails.

    scripts/checks/planted_bugs.py [BUG ...]

A test that no bug can fail says nothing. Prints a row of Markdown for each bug; exit code 1 where one went unseen.
"""
import os
import pathlib
import shutil
import subprocess
import sys
import time

ROOT = pathlib.Path(__file__).resolve().parents[2]
COPY = ROOT / "target" / "planted"
# Beside the copy, so that what it depends on is built once.
ENVIRONMENT = dict(os.environ, CARGO_TARGET_DIR=str(ROOT / "target" / "planted-build"), CARGO_INCREMENTAL="1")

# name: what it stands for, edits (file, before, after), tests (target, name)
BUGS = {
    "biased-exit": (
        "the first exit of every void is 1 % too likely",
        [("src/walk/exits.rs", "f64::from(u8::from(!blocked[c]));", "f64::from(u8::from(!blocked[c])) * if c == first { 1.01 } else { 1.0 };")],
        [
            ("model", "exact_answers::passive_particles_take_three_moves_a_layer"),
            ("model", "walk_against_reference::kernel_and_reference_agree_particle_by_particle"),
        ],
    ),
    "reused-stream": (
        "the second run steps with the numbers of the first",
        [("src/walk/kernel/mod.rs", "purpose: Purpose::Step,\n        run: state.run,", "purpose: Purpose::Step,\n        run: 1,")],
        [("model", "walk_against_reference::kernel_and_reference_agree_particle_by_particle")],
    ),
    "reused-increment": (
        "streams do not depend on the increment",
        [("src/stream.rs", "self.run, self.increment, self.chunk]", "self.run, 0, self.chunk]")],
        [("lib", "stream::tests::every_part_of_the_key_matters")],
    ),
    "tie": (
        "a particle as coarse as the constriction is stopped (`<` for `<=`)",
        [
            ("src/walk/exits.rs", "network.finest_open(|c| blocked[c]).to_bits();", "network.finest_open(|c| blocked[c]).to_bits() - 1;"),
            ("src/walk/kernel/lattice.rs", "limit && d > self.exits", "limit && d >= self.exits"),
            ("src/walk/kernel/avx512.rs", "_mm512_mask_cmpgt_epi32_mask(able, d, width)", "_mm512_mask_cmpge_epi32_mask(able, d, width)"),
            ("src/walk/kernel/lattice.rs", "if d > self.exits.passive_limit", "if d >= self.exits.passive_limit"),
        ],
        [("model", "exact_answers::a_particle_as_coarse_as_the_constriction_passes")],
    ),
    "lost-particle": (
        "one particle in 1.2 million vanishes",
        [
            (
                "src/walk/kernel/mod.rs",
                "*live = kept as u32;",
                "*live = kept as u32 - u32::from(kept > 0 && key.chunk == 61 && key.increment == 84);",
            )
        ],
        [("model", "exact_answers::a_million_particles_are_all_accounted_for")],
    ),
    "binomial-switch": (
        "a binomial draw at the switch between its methods makes one trial too few",
        [
            (
                "src/walk/counts/binomial/mod.rs",
                "below_both(draws, n, [p, p])[0]",
                "below_both(draws, n - u64::from(n == FEW), [p, p])[0]",
            )
        ],
        [("lib", "walk::counts::binomial::tests::draws_follow_the_binomial_distribution")],
    ),
    "weak-permutation": (
        "strata are shuffled by too few rounds",
        [("src/walk/strata.rs", "const ROUNDS: u64 = 10;", "const ROUNDS: u64 = 4;")],
        [("lib", "walk::strata::tests::pairs_of_images_are_as_frequent_as_in_random_permutations")],
    ),
}


def test(target, name):
    """Whether a test passes, and its last words."""
    where = ["--lib"] if target == "lib" else ["--test", target]
    command = ["cargo", "test", "--release", "--quiet", *where, "--", "--exact", name]
    done = subprocess.run(command, cwd=COPY, capture_output=True, text=True, env=ENVIRONMENT)
    text = done.stdout + done.stderr
    if "error: could not compile" in text:
        sys.exit(f"the planted bug does not compile:\n{text[-3000:]}")
    if " 0 passed; 0 failed" in text:
        sys.exit(f"{target}: there is no test {name}")
    panics = [line for line in text.splitlines() if "panicked at" in line]
    return done.returncode == 0, panics[0].split("panicked at ")[1].rstrip(":") if panics else ""


def plant(edits):
    for file, before, after in edits:
        path = COPY / file
        text = path.read_text()
        if text.count(before) != 1:
            sys.exit(f"{file}: `{before}` is there {text.count(before)} times, not once: fix this script")
        path.write_text(text.replace(before, after))


def main():
    wanted = sys.argv[1:] or list(BUGS)
    shutil.rmtree(COPY, ignore_errors=True)
    for part in ["src", "tests", "benches", "results/readme", "scripts/examples", "scripts/python"]:
        if (ROOT / part).exists():
            shutil.copytree(ROOT / part, COPY / part)
    for file in ["Cargo.toml", "Cargo.lock", "build.rs", "rustfmt.toml", "README.md"]:
        shutil.copy(ROOT / file, COPY / file)
    print("| planted | named test | seen | first panic | s |")
    print("|---|---|---|---|---|")
    unseen = 0
    for name in wanted:
        what, edits, tests = BUGS[name]
        originals = {file: (COPY / file).read_text() for file, _, _ in edits}
        for target, test_name in tests:
            if not test(target, test_name)[0]:
                sys.exit(f"{test_name} fails without any bug")
        plant(edits)
        for target, test_name in tests:
            begun = time.time()
            passed, panic = test(target, test_name)
            unseen += passed
            print(f"| {what} | `{target}: {test_name}` | {'NO' if passed else 'yes'} | `{panic}` | {time.time() - begun:.0f} |", flush=True)
        for file, text in originals.items():
            (COPY / file).write_text(text)
    sys.exit(1 if unseen else 0)


main()
