"""Networks from elsewhere, and the first particle on them against linear algebra."""

from __future__ import annotations

import os
import pickle
from pathlib import Path
from typing import Any, Tuple

import numpy as np
import pytest
from conftest import lattice

import voidwalk as vw


def random_network(seed: int, exit: str) -> Tuple[vw.Network, float]:
    """Voids in a row with random constrictions among near ones, and a size that some of them stop."""
    draw = np.random.default_rng(seed)
    count = 24
    pairs = [(a, b) for a in range(count) for b in range(a + 1, min(a + 5, count))]
    conns = np.array([pair for pair in pairs if pair[1] == pair[0] + 1 or draw.random() < 0.6])
    if exit != "area":
        conns = np.where(draw.random(len(conns))[:, None] < 0.5, conns, conns[:, ::-1])
    diameter = draw.uniform(0.1, 0.5, len(conns)).astype(np.float32).astype(float)
    network = vw.Network(
        conns, diameter, inlets=[0, 1, 2], outlets=[count - 2, count - 1], exit=exit, count=count
    )
    return network, float(np.quantile(diameter, 0.2))


def first_particle(network: vw.Network, size: float) -> float:
    """Probability that a first particle leaves, by dense linear algebra on the arrays alone."""
    n, conns, diameter = network.count, network.conns, network.diameter
    move = np.zeros((n, n))
    leave = np.zeros(n)
    if network.exit == "area":
        weight = np.zeros(n)
        wide = 1e60
        np.add.at(weight, conns[:, 0], diameter**2)
        weight[network.outlets] += wide
        leave[network.outlets] = wide / weight[network.outlets]
        for (a, b), d in zip(conns, diameter):
            if d >= size:
                move[a, b] += d**2 / weight[a]
        enter = np.zeros(n)
        enter[network.inlets] = 1 / len(network.inlets)
    else:
        g = diameter**4
        mean = g.mean()
        system, source = np.zeros((n, n)), np.zeros(n)
        for (a, b), c in zip(conns, g):
            system[[a, b], [a, b]] += c
            system[[a, b], [b, a]] -= c
        system[network.inlets, network.inlets] += mean
        source[network.inlets] += mean
        system[network.outlets, network.outlets] += mean
        p = np.linalg.solve(system, source)
        flux = g * (p[conns[:, 0]] - p[conns[:, 1]])
        way_in, way_out = mean * (1 - p[network.inlets]), mean * p[network.outlets]
        start, end = np.where(flux > 0, conns.T, conns.T[::-1])
        weight = np.abs(flux) if network.exit == "flux" else diameter**2
        total = np.zeros(n)
        np.add.at(total, start, weight)
        out = way_out if network.exit == "flux" else np.full(len(way_out), 1e60)
        total[network.outlets] += out
        leave[network.outlets] = out / total[network.outlets]
        for a, b, w, d in zip(start, end, weight, diameter):
            if d >= size:
                move[a, b] += w / total[a]
        enter = np.zeros(n)
        enter[network.inlets] = way_in / way_in.sum() if network.exit == "flux" else 1 / len(network.inlets)
    return float(enter @ np.linalg.solve(np.eye(n) - move, leave))


RULES = ["flux", "area", "area-along-flow"]


@pytest.mark.parametrize("seed", range(21))
def test_the_first_particle_fares_as_linear_algebra_says(seed: int) -> None:
    """Twenty-one networks, seven of each rule: Eq. (1) of the library to six digits, and 2,000 walks of one particle
    each within four standard errors: a probability that is off by 0.045 would be seen."""
    network, size = random_network(seed, RULES[seed % 3])
    expected = first_particle(network, size)
    assert 0.02 < expected < 0.98
    assert network.first_passage(size)[0] == pytest.approx(expected, abs=2e-6)
    walks = 2000
    result = vw.walk(network, size, n_base=1, increments=1, runs=1, replicates=walks, seed=seed + 1)
    share = result.eroded_mass_fraction().mean()
    z = (share - expected) / np.sqrt(expected * (1 - expected) / walks)
    print(f"{network.exit:16} seed {seed:2}  expected {expected:.4f}  walked {share:.4f}  z {z:+.2f}")
    assert abs(z) < 4


def test_the_flow_is_that_of_linear_algebra() -> None:
    network, _ = random_network(3, "flux")
    pressure, flux = network.flow()
    kept = np.zeros(network.count)
    np.add.at(kept, network.conns[:, 0], flux)
    np.add.at(kept, network.conns[:, 1], -flux)
    inner = np.setdiff1d(np.arange(network.count), np.concatenate([network.inlets, network.outlets]))
    assert np.abs(kept[inner]).max() < 1e-6 * np.abs(flux).max()
    g = network.diameter**4
    drop = pressure[network.conns[:, 0]] - pressure[network.conns[:, 1]]
    assert flux == pytest.approx(g * drop, rel=1e-5)
    with pytest.raises(ValueError, match="no water flows"):
        lattice().flow()


def test_a_lattice_gives_its_arrays_and_comes_back_from_them() -> None:
    made = lattice()
    assert made.conns.shape == (972, 2) and (made.conns[:, 1] == -1).sum() == 36
    again = vw.Network(made.conns, made.diameter, made.inlets, made.outlets, exit="area", count=made.count)
    assert again.fingerprint == made.fingerprint
    assert made.layer.tolist() == [v // 36 for v in range(324)]
    one, other = (vw.walk(n, 0.25, n_base=5000, replicates=2) for n in (made, again))
    assert np.array_equal(one.blocked, other.blocked) and one.series.keys() == other.series.keys()
    assert all(np.array_equal(one.series[k], other.series[k]) for k in one.series)


@pytest.mark.parametrize("exit", ["area", "flux"])
def test_networks_are_pickled_whole(exit: str) -> None:
    for network in (vw.Network.cubic([4, 4, 5], exit=exit), random_network(1, exit)[0]):
        again = pickle.loads(pickle.dumps(network))
        assert again.fingerprint == network.fingerprint and repr(again) == repr(network)
        assert np.array_equal(again.conns, network.conns)


def test_a_network_is_written_as_a_scene_reads_it(tmp_path: Any, small: Any) -> None:
    network = lattice()
    network.to_file(tmp_path / "net.csv")
    assert np.array_equal(vw.Network.from_file(tmp_path / "net.csv").conns, network.conns)
    scene = {
        **small,
        "filter": {"cu": 1.5},
        "network": {"file": tmp_path / "net.csv"},
        "record": {"sensitivity": [], "size_curves": []},
        "base": {"cu": 1.5, "d85_mm": 0.2, "n_base": 20_000},
    }
    named = vw.run(scene)
    given = vw.walk(network, vw.Gradation.linear(1.5, 0.2, 85), n_base=20_000, replicates=2, seed=11)
    for table in ("series", "layers", "retained", "eroded"):
        ours, theirs = getattr(given, table), getattr(named, table)
        assert ours.keys() == theirs.keys()
        for key in ours:
            assert np.array_equal(ours[key], theirs[key]), (table, key)
    assert given.verdict == named.model["class"]
    with pytest.raises(ValueError, match="this network has none"):
        random_network(1, "flux")[0].to_file(tmp_path / "other.csv")


def test_a_dict_of_openpnm_goes_there_and_back() -> None:
    network = random_network(2, "flux")[0]
    there = network.to_openpnm()
    back = vw.Network.from_openpnm(there)
    assert back.fingerprint == network.fingerprint or np.allclose(back.diameter, network.diameter)
    assert np.array_equal(back.conns, network.conns) and np.array_equal(back.inlets, network.inlets)
    # Ways out with a size of their own end in pores of their own.
    boundary = lattice().to_openpnm()
    assert boundary["throat.conns"].min() == 0 and boundary["pore.outlets"].sum() == 36
    assert len(boundary["pore.coords"]) == len(boundary["pore.outlets"]) == 324 + 36
    with pytest.raises(ValueError, match="no pores labelled pore.inlets"):
        vw.Network.from_openpnm({k: v for k, v in there.items() if k != "pore.inlets"})
    with pytest.raises(ValueError, match="'throat.diameter'; it is needed"):
        vw.Network.from_openpnm({"throat.conns": [[0, 1]]})


def test_networks_of_openpnm_are_walked() -> None:
    op = pytest.importorskip("openpnm")
    draw = np.random.default_rng(4)
    cubic = op.network.Cubic(shape=[8, 6, 6], spacing=1e-3)
    cubic["throat.diameter"] = draw.uniform(1e-4, 4e-4, cubic.Nt)
    delaunay = op.network.Delaunay(points=200, shape=[1, 1, 1])
    op.topotools.trim(delaunay, pores=delaunay.pores("boundary")) if "pore.boundary" in delaunay else None
    delaunay["throat.diameter"] = draw.uniform(1e-4, 4e-4, delaunay.Nt)
    x = delaunay["pore.coords"][:, 0]
    sides = [x < np.quantile(x, 0.1), x > np.quantile(x, 0.9)]
    for pn, inlets, outlets in [(cubic, "left", "right"), (delaunay, *sides)]:
        network = vw.Network.from_openpnm(pn, inlets, outlets)
        assert (network.count, len(network)) == (pn.Np, pn.Nt)
        assert network.diameter == pytest.approx(1e3 * pn["throat.diameter"])
        result = vw.walk(network, 0.2, n_base=2000, replicates=3)
        assert result.blocked is not None
        stopped = result.blocked.any(axis=(0, 1))
        assert stopped.any() and (network.diameter[stopped] < 0.2).all()
        expected = first_particle(network, 0.2)
        walks = vw.walk(network, 0.2, n_base=1, increments=1, runs=1, replicates=1000)
        z = (walks.eroded_mass_fraction().mean() - expected) / np.sqrt(expected * (1 - expected) / 1000)
        assert abs(z) < 4
    pn = op.io.network_from_dict(network.to_openpnm()) if hasattr(op.io, "network_from_dict") else None
    assert pn is None or pn.Nt == len(network)


def test_a_network_of_porespy_is_walked() -> None:
    ps = pytest.importorskip("porespy")
    image = ps.generators.blobs([40, 40, 40], porosity=0.6, blobiness=1, seed=3)
    found = ps.networks.snow2(image, boundary_width=0, voxel_size=0.01).network
    x = found["pore.coords"][:, 0]
    network = vw.Network.from_porespy(found, x < np.quantile(x, 0.2), x > np.quantile(x, 0.8))
    assert len(network) == len(found["throat.conns"])
    result = vw.walk(network, float(np.median(network.diameter)), n_base=500, replicates=2)
    assert result.verdict in ("no erosion", "some erosion", "continuing erosion", "undecided")
    assert result.replicates[0]["runs"][0]["inserted"] == 500


def test_the_number_of_base_particles_is_never_guessed() -> None:
    """A lattice with a shipped curve knows its filter, and so what Eq. (2) asks for; another network is asked about."""
    base, made = vw.Gradation.linear(1.5, 0.25, 85), vw.Network.cubic([10, 10, 12], "cu1.5-loose", d0_mm=1.0)
    filter = vw.Gradation.linear(1.5)
    assert made.filter == filter and made.grains_per_void == vw.Curve.shipped("cu1.5-loose").grains_per_void
    eq2 = base.base_particles(filter, made.count, made.grains_per_void)
    assert vw.walk(made, base, replicates=2).outcome["n_base"] == eq2
    again = pickle.loads(pickle.dumps(made))
    assert again.filter == filter and vw.walk(lambda seed: again, base, replicates=2).outcome["n_base"] == eq2
    assert vw.walk(made, base, replicates=2, mass_ratio=0.1).outcome["n_base"] == pytest.approx(2 * eq2, abs=1)
    plain = vw.Network(made.conns, made.diameter, made.inlets, made.outlets, exit="area", count=made.count)
    with pytest.raises(ValueError, match="n_base is missing.*Give n_base, or filter and grains_per_void, which"):
        vw.walk(plain, base)
    with pytest.raises(ValueError, match="or grains_per_void, which this network does not know"):
        vw.walk(plain, base, filter=filter)
    with pytest.raises(ValueError, match="or filter, which this network does not know"):
        vw.walk(plain, base, grains_per_void=0.6)
    given = vw.walk(plain, base, filter=filter, grains_per_void=made.grains_per_void, replicates=2)
    assert given.outcome["n_base"] == given.outcome["n_base_eq2"] == eq2
    with pytest.raises(ValueError, match="filter = float is not allowed; a file, a Gradation"):
        vw.walk(plain, base, filter=1.0)  # type: ignore[arg-type]
    # A soil in any form, as `judge` takes it.
    sizes, percents = [0.5, 2.0], [0.0, 100.0]
    forms = [vw.Gradation(sizes, percents), (sizes, percents)]
    rows = [vw.walk(plain, base, filter=form, grains_per_void=0.6, replicates=1).row() for form in forms]
    assert rows[0] == rows[1] and rows[0]["d15f_mm"] == pytest.approx(vw.Gradation(sizes, percents).d(15))


def test_a_walk_has_notes_with_a_sentence_each() -> None:
    made, base = vw.Network.cubic([10, 10, 12]), vw.Gradation.linear(1.5, 0.25, 85)
    few = vw.walk(made, base, n_base=1000, replicates=6)
    assert few.notes and all(note["id"] for note in few.notes)
    assert len(few.note_sentences) == len(few.notes) and all(few.note_sentences)
    assert few.verdict in repr(few) and few.verdict in few._repr_html_()


@pytest.mark.skipif(not hasattr(os, "mkfifo"), reason="no pipes here")
def test_a_pipe_is_no_network(tmp_path: Path) -> None:
    os.mkfifo(tmp_path / "pipe")
    with pytest.raises(ValueError, match="not a regular file"):
        vw.Network.from_file(tmp_path / "pipe")
