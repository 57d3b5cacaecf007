"""Networks of voids and constrictions: lattices, the voids of a packing, networks of OpenPNM and PoreSpy."""

from __future__ import annotations

import os
from typing import Callable, Dict, Mapping, Optional, Sequence, Tuple, Type, Union

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import _voidwalk
from ._arrays import Floats, Ints, floats, frozen, ints, pores, whole
from ._boxes import box
from ._grains import MERGE_OVERLAP, Constrictions, Packing
from ._plots import Axes, plot_network
from ._soil import Curve, Gradation

__all__ = ["Network"]

#: Labels of OpenPNM and PoreSpy that are taken for the sides that particles come in and leave by.
_IN = ("pore.inlets", "pore.left", "pore.xmin")
_OUT = ("pore.outlets", "pore.right", "pore.xmax")


class Network:
    """Voids (pores) joined by constrictions (throats), with ways in and out.

    Base particles come in at the inlets, move from void to void and leave at the outlets. A constriction can be
    passed both ways, one blocking closes both, and water that flows from the inlets to the outlets says which way
    a particle goes; with ``exit="area"`` each constriction leads from its first void to its second instead.

    Parameters
    ----------
    conns : array_like of int, shape (n, 2)
        The two voids that each constriction joins, counted from 0; -1 is the outside: before the filter as
        the first of the two, behind it as the second.
    diameter : array_like of float, shape (n,)
        Diameter (mm) of each constriction; 0 is closed from the start.
    inlets, outlets : array_like of int, or of bool by void
        Voids that particles come into, and leave from, by ways that nothing can block. Such a way conducts
        water as a constriction does on average.
    exit : {"flux", "area-along-flow", "area"}
        How a particle chooses among the open exits of its void: by the flow of water; by area among those
        that water leaves by; by area along the direction of conns (the paper's model).
    conductance : array_like of float, shape (n,), optional
        Conductance of each constriction for water in any one unit; the fourth power of the diameter without
        it. Not with ``exit="area"``.
    rho : float
        Part of its conductance that a blocked constriction keeps, 0 to below 1.
    count : int, optional
        Number of voids; the largest that is named, and one more, without it.
    coords : array_like of float, shape (count, 3), optional
        Centres of the voids, for those who draw them: nothing depends on them.
    reference_mm : float
        Length that diameters are held in units of, to 24 bits each. A scene's is the filter's smallest grain.

    Raises
    ------
    ValueError
        What is no network that anything can pass, with the place and what is allowed.

    Examples
    --------
    A wide and a narrow way beside each other; a particle of 0.5 mm blocks the narrow one.

    >>> import voidwalk as vw
    >>> ring = vw.Network([[0, 1], [1, 2], [0, 3], [3, 2]], [1.0, 1.0, 0.4, 0.4], inlets=[0], outlets=[2])
    >>> result = vw.walk(ring, 0.5, n_base=1000, replicates=2)
    >>> result.blocked[0, 0].tolist()
    [False, False, True, False]
    """

    # Their meanings, which help() shows.
    __slots__ = {
        "_native": "",
        "_made": "",
        "conns": "Voids at both ends of each constriction, shape (n, 2); -1 is the outside.",
        "diameter": "Diameter (mm) by constriction, shape (n,).",
        "inlets": "Voids that particles come into.",
        "outlets": "Voids that particles leave by ways that nothing can block.",
        "coords": "Centres of the voids, shape (count, 3), or None.",
        "conductance": "Conductance by constriction as it was given, or None.",
        "rho": "Part of its conductance that a blocked constriction keeps.",
        "filter": "Gradation of the filter, where it is known: of lattices with a shipped curve; else None.",
        "grains_per_void": "Filter grains per void, where known: of lattices with a shipped or measured curve, and "
        "of packings; else None.",
    }

    def __init__(
        self,
        conns: ArrayLike,
        diameter: ArrayLike,
        inlets: ArrayLike,
        outlets: ArrayLike,
        *,
        exit: str = "flux",
        conductance: Optional[ArrayLike] = None,
        rho: float = 0.0,
        count: Optional[int] = None,
        coords: Optional[ArrayLike] = None,
        reference_mm: float = 1.0,
    ) -> None:
        self.conns = frozen(ints("conns", conns, None, 2))
        self.diameter = frozen(floats("diameter", diameter, len(self.conns)))
        self.conductance = None if conductance is None else frozen(floats("conductance", conductance, len(self.conns)))
        if count is None:
            count = _count(self.conns, inlets, outlets, coords)
        self.inlets = frozen(pores("inlets", inlets, count))
        self.outlets = frozen(pores("outlets", outlets, count))
        self.coords = None if coords is None else frozen(floats("coords", coords, count, 3))
        self.rho = float(rho)
        self.filter: Optional[Gradation] = None
        self.grains_per_void: Optional[float] = None
        self._native = _voidwalk.Network.from_columns(
            whole("count", count), self.conns, self.diameter, self.conductance, self.inlets, self.outlets, exit,
            self.rho, float(reference_mm),
        )
        made = dict(
            conns=self.conns, diameter=self.diameter, inlets=self.inlets, outlets=self.outlets, exit=exit,
            conductance=self.conductance, rho=self.rho, count=count, coords=self.coords, reference_mm=reference_mm,
        )
        self._made: Tuple[str, Mapping[str, object]] = ("", made)

    @classmethod
    def _of(
        cls, native: _voidwalk.Network, made: str, arguments: Mapping[str, object], coords: Optional[Floats], rho: float
    ) -> Network:
        new = cls.__new__(cls)
        new._native, new._made, new.coords, new.conductance, new.rho = native, (made, arguments), coords, None, rho
        new.filter, new.grains_per_void = None, None
        new.conns, new.diameter = frozen(native.conns()), frozen(native.diameter())
        new.inlets, new.outlets = frozen(native.inlets()), frozen(native.outlets())
        return new

    @classmethod
    def cubic(
        cls,
        shape: Sequence[int],
        curve: Union[str, Curve] = "cu1.5-loose",
        *,
        d0_mm: float = 1.0,
        seed: int = 1,
        exit: str = "area",
        rho: float = 0.0,
        reference_mm: Optional[float] = None,
    ) -> Network:
        """The paper's lattice: periodic in x and y, particles move along +x, +y and +z, in at the first layer and out
        of the last.

        Parameters
        ----------
        shape : sequence of int, shape (3,)
            Voids along x, y and z.
        curve : str or Curve
            Sizes of the constrictions, drawn independently: the name of a shipped curve, or a curve.
        d0_mm : float
            Smallest grain (mm) of the filter that a shipped curve is scaled to.
        seed : int
            The same seed gives the same bits. Replicate r of a scene has ``replicate_seed(seed, r)``.
        exit : {"area", "flux", "area-along-flow"}
            As for the class; with the last two constrictions lose their direction, and water flows along +z.
        rho : float
            As for the class.
        reference_mm : float, optional
            As for the class; `d0_mm` without it.

        Examples
        --------
        >>> import voidwalk as vw
        >>> vw.Network.cubic([10, 10, 20], "cu1.5-loose", seed=7)
        Network(2000 voids, 6000 constrictions, 100 inlets, exit by area)
        """
        sizes = [whole("shape", n) for n in ints("shape", shape, 3).tolist()]
        sizes_curve = Curve.shipped(curve, d0_mm) if isinstance(curve, str) else curve
        if not isinstance(sizes_curve, Curve):
            raise ValueError(f"curve = {curve!r} is not allowed; the name of a shipped curve, or a Curve")
        unit = d0_mm if reference_mm is None else reference_mm
        if max(sizes) >= 2**32:
            raise ValueError(f"shape = {sizes} is not allowed; three whole numbers below {2**32}")
        native = _voidwalk.Network.cubic(
            (sizes[0], sizes[1], sizes[2]), sizes_curve._native, unit, whole("seed", seed), exit, rho
        )
        made = dict(shape=sizes, curve=sizes_curve, seed=seed, exit=exit, rho=rho, reference_mm=unit)
        z, y, x = np.meshgrid(*[np.arange(float(n)) for n in sizes[::-1]], indexing="ij")
        coords = np.stack([x.ravel(), y.ravel(), z.ravel()], axis=1)
        new = cls._of(native, "cubic", made, frozen(coords), rho)
        new.filter, new.grains_per_void = sizes_curve.filter, sizes_curve.grains_per_void
        return new

    @classmethod
    def from_packing(
        cls,
        packing: Union[Packing, Constrictions],
        *,
        copies: int = 1,
        exit: str = "flux",
        rho: float = 0.0,
        merge_overlap: float = MERGE_OVERLAP,
    ) -> Network:
        """The voids of a periodic packing, in equal copies of its cell one behind the other along z.

        Parameters
        ----------
        packing : Packing or Constrictions
            Grains in a periodic cell.
        copies : int
            Copies of the cell along the flow.
        exit : {"flux", "area-along-flow", "height"}
            How a particle chooses: as for the class, or by area among the exits that lead upwards in z.
        rho, merge_overlap : float
            As for the class and for :func:`constrictions`.
        """
        if isinstance(packing, Constrictions):
            merge_overlap, packing = packing.merge_overlap, packing.packing
        number = whole("copies", copies, 1)
        if number >= 2**32:
            raise ValueError(f"copies = {number} is not allowed; a whole number below {2**32}")
        native = _voidwalk.Network.of_packing(packing._columns, merge_overlap, number, exit, rho)
        made = dict(packing=packing, copies=number, exit=exit, rho=rho, merge_overlap=merge_overlap)
        new = cls._of(native, "from_packing", made, None, rho)
        # Copies have as many grains a void as the cell.
        new.grains_per_void = len(packing) * number / new.count
        return new

    @classmethod
    def from_file(cls, path: Union[str, os.PathLike[str]], reference_mm: float = 1.0) -> Network:
        """A directed network from a CSV file, as a scene names it as ``network.file``: rows ``from,to,diameter_mm``."""
        native = _voidwalk.Network.from_csv(os.fspath(path), reference_mm)
        conns, diameter = native.conns(), native.diameter()
        return cls(
            conns, diameter, native.inlets(), native.outlets(), exit="area", count=native.pores,
            reference_mm=reference_mm,
        )

    @classmethod
    def from_openpnm(
        cls,
        pn: Mapping[str, object],
        inlets: Union[None, str, ArrayLike] = None,
        outlets: Union[None, str, ArrayLike] = None,
        *,
        diameter: str = "throat.diameter",
        conductance: Optional[str] = None,
        unit_mm: float = 1000.0,
        exit: str = "flux",
        rho: float = 0.0,
        count: Optional[int] = None,
        reference_mm: float = 1.0,
    ) -> Network:
        """A network of OpenPNM, or a dict with the same keys.

        Parameters
        ----------
        pn : openpnm.network.Network or mapping
            ``throat.conns`` and the keys below; ``pore.coords`` is kept.
        inlets, outlets : str, array_like of int, or of bool by pore, optional
            Labels of `pn`, or pores. The labels inlets and outlets, left and right, or xmin and xmax without
            them.
        diameter : str
            Key of the diameters.
        conductance : str, optional
            Key of the conductances, as ``throat.hydraulic_conductance``; the fourth power of the diameter
            without it.
        unit_mm : float
            Length (mm) of the unit of `pn`: OpenPNM's is the metre.
        exit, rho, count, reference_mm
            As for the class.

        Examples
        --------
        >>> import numpy as np, voidwalk as vw
        >>> pn = {
        ...     "throat.conns": np.array([[0, 1], [1, 2]]),
        ...     "throat.diameter": np.array([3e-4, 2e-4]),
        ...     "pore.left": np.array([True, False, False]),
        ...     "pore.right": np.array([False, False, True]),
        ... }
        >>> vw.Network.from_openpnm(pn).diameter.round(6).tolist()
        [0.3, 0.2]
        """
        for key in ("throat.conns", diameter, *([conductance] if conductance else [])):
            if key not in pn:
                raise ValueError(f"the network has no {key!r}; it is needed")
        coords = np.asarray(pn["pore.coords"]) * unit_mm if "pore.coords" in pn else None
        return cls(
            np.asarray(pn["throat.conns"]), floats(diameter, pn[diameter], None) * unit_mm,
            _side(pn, inlets, "inlets", _IN), _side(pn, outlets, "outlets", _OUT),
            conductance=None if conductance is None else np.asarray(pn[conductance]), coords=coords, exit=exit,
            rho=rho, count=count, reference_mm=reference_mm,
        )

    @classmethod
    def from_porespy(
        cls,
        net: Mapping[str, object],
        inlets: Union[None, str, ArrayLike] = None,
        outlets: Union[None, str, ArrayLike] = None,
        *,
        diameter: str = "throat.inscribed_diameter",
        unit_mm: float = 1.0,
        conductance: Optional[str] = None,
        exit: str = "flux",
        rho: float = 0.0,
        count: Optional[int] = None,
        reference_mm: float = 1.0,
    ) -> Network:
        """A network that PoreSpy extracted, as ``porespy.networks.snow2(...).network``.

        As :meth:`from_openpnm`, with PoreSpy's name of the diameter and the length (mm) of the unit of its
        ``voxel_size``.
        """
        return cls.from_openpnm(
            net, inlets, outlets, diameter=diameter, conductance=conductance, unit_mm=unit_mm, exit=exit, rho=rho,
            count=count, reference_mm=reference_mm,
        )

    @property
    def count(self) -> int:
        """Number of voids."""
        return self._native.pores

    @property
    def exit(self) -> str:
        """How a particle chooses among the open exits of its void."""
        return self._native.exit

    @property
    def fingerprint(self) -> str:
        """A hash of everything that a walk takes from the network."""
        return self._native.fingerprint

    @property
    def layer(self) -> Ints:
        """Layer of each void, shape (count,): the fewest constrictions from an inlet, or z on a lattice; -1 where
        nothing leads to it."""
        return self._native.layer()

    def first_passage(self, diameter: float) -> Tuple[float, float]:
        """What the first particle of a diameter can expect on the network before anything is blocked.

        Parameters
        ----------
        diameter : float
            Diameter (mm).

        Returns
        -------
        probability : float
            That it leaves the filter.
        moves : float
            Its mean number of moves.

        Raises
        ------
        VoidwalkError
            Conductances so many orders apart that the flow cannot be told, where it says the way.

        Examples
        --------
        >>> import voidwalk as vw
        >>> lattice = vw.Network.cubic([6, 6, 9])
        >>> probability, moves = lattice.first_passage(0.01)
        >>> round(probability, 9), moves > 9
        (1.0, True)
        """
        return self._native.first_passage(float(diameter))

    def flow(self) -> Tuple[Floats, Floats]:
        """The flow of water before anything is blocked.

        Returns
        -------
        pressure : ndarray, shape (count,)
            By void: 1 before the filter, 0 behind it.
        flux : ndarray, shape (n,)
            Flow times viscosity through each constriction from its first void to its second, in the unit of
            the conductances.

        Raises
        ------
        ValueError
            A network whose particles choose by area.
        VoidwalkError
            Conductances so many orders apart that the flow cannot be told.
        """
        return self._native.flow()

    def without(self, mask: ArrayLike) -> Network:
        """The network with some constrictions closed from the start, as blocked ones of a walk are.

        Parameters
        ----------
        mask : array_like of bool, shape (n,)
            Which constrictions are closed.

        Returns
        -------
        Network
            With the same voids, constrictions, filter and grains per void. The diameter of a closed constriction
            is 0, and it keeps the part `rho` of its conductance.

        Raises
        ------
        ValueError
            A mask of another shape; or a network whose particles choose by height, which is made of a packing.

        Examples
        --------
        >>> import voidwalk as vw
        >>> network = vw.Network.cubic([6, 6, 9])
        >>> blocked = vw.walk(network, 0.2, n_base=1000, replicates=1).blocked[0, 0]
        >>> int((network.without(blocked).diameter == 0).sum()) == int(blocked.sum())
        True
        """
        closed = np.asarray(mask)
        if closed.dtype.kind != "b" or closed.shape != self.diameter.shape:
            raise ValueError(
                f"mask is {closed.dtype} of shape {closed.shape}; bool of shape {self.diameter.shape} is needed"
            )
        if self.exit not in ("flux", "area-along-flow", "area"):
            raise ValueError(f"a network whose particles choose by {self.exit} cannot be made without constrictions")
        new = Network(
            self.conns, np.where(closed, 0.0, self.diameter), self.inlets, self.outlets, exit=self.exit,
            conductance=None if self.exit == "area" else np.where(closed, self.rho, 1.0) * self._native.conductance(),
            rho=self.rho, count=self.count, coords=self.coords, reference_mm=self._native.unit_mm,
        )
        new.filter, new.grains_per_void = self.filter, self.grains_per_void
        return new

    def plot(self, ax: Optional[Axes] = None, *, blocked: Optional[ArrayLike] = None) -> Axes:
        """Draws the sizes of the constrictions; or, where it is said which are blocked, their share by layer.

        Parameters
        ----------
        ax : matplotlib.axes.Axes, optional
            Where to; a new figure without it.
        blocked : array_like of bool, shape (n,), optional
            Which constrictions are blocked, as a run of ``Result.blocked``.
        """
        layer, ends = self.layer, self.conns
        # A constriction belongs to the layer of the void that it leads from.
        of_throat = np.where(ends[:, 0] < 0, -1, layer[ends[:, 0]])
        return plot_network(self.diameter, of_throat, None if blocked is None else np.asarray(blocked, dtype=bool), ax)

    def to_openpnm(self) -> Dict[str, Union[Floats, Ints, NDArray[np.bool_]]]:
        """The network as a dict with OpenPNM's keys, lengths in m.

        Constrictions that lead outside end in boundary pores of their own, so that every conns names two pores.
        ``pore.inlets`` and ``pore.outlets`` are masks. Which way a constriction leads is only in the order of
        its two pores.
        """
        conns = np.array(self.conns)
        before, behind = np.flatnonzero(conns[:, 0] < 0), np.flatnonzero(conns[:, 1] < 0)
        inner, total = self.count, self.count + len(before) + len(behind)
        conns[before, 0] = inner + np.arange(len(before))
        conns[behind, 1] = inner + len(before) + np.arange(len(behind))
        is_in, is_out = np.zeros(total, dtype=bool), np.zeros(total, dtype=bool)
        is_in[self.inlets] = True
        is_in[inner : inner + len(before)] = True
        is_out[self.outlets] = True
        is_out[inner + len(before) :] = True
        found: Dict[str, Union[Floats, Ints, NDArray[np.bool_]]] = {
            "throat.conns": conns,
            "throat.diameter": self.diameter * 1e-3,
            "pore.inlets": is_in,
            "pore.outlets": is_out,
        }
        if self.coords is not None:
            beside = [conns[before, 1], conns[behind, 0]]
            found["pore.coords"] = np.concatenate([self.coords, *[self.coords[b] for b in beside]]) * 1e-3
        return found

    def to_file(self, path: Union[str, os.PathLike[str]]) -> None:
        """Writes a directed network as the CSV file that a scene names as ``network.file``."""
        text = self._native.to_csv()
        with open(path, "wb") as file:
            file.write(text)

    def __len__(self) -> int:
        return len(self.diameter)

    def __eq__(self, other: object) -> bool:
        if not isinstance(other, Network):
            return NotImplemented
        same = (self.filter, self.grains_per_void) == (other.filter, other.grains_per_void)
        return same and self.fingerprint == other.fingerprint

    def __hash__(self) -> int:
        return hash(self.fingerprint)

    def __reduce__(self) -> Tuple[object, ...]:
        return _remade, (type(self), *self._made)

    def __repr__(self) -> str:
        inlets = int(len(self.inlets) + np.count_nonzero(self.conns[:, 0] < 0))
        return f"Network({self.count} voids, {len(self)} constrictions, {inlets} inlets, exit by {self.exit})"

    def _repr_html_(self) -> str:
        sizes = self.diameter[self.diameter > 0]
        spread = "none"
        if len(sizes):
            spread = f"{sizes.min():.4g} to {sizes.max():.4g} mm, median {np.median(sizes):.4g} mm"
        facts = {
            "Voids": f"{self.count:,}",
            "Layers": f"{self._native.layers:,}",
            "Constrictions": f"{len(self):,}, closed {len(self) - len(sizes):,}",
            "Diameters": spread,
            "Particles choose by": self.exit,
            "Filter grains per void": "not known" if self.grains_per_void is None else f"{self.grains_per_void:.3g}",
        }
        return box("Network", facts)


def _remade(kind: Type[Network], made: str, arguments: Mapping[str, object]) -> Network:
    maker: Callable[..., Network] = getattr(kind, made) if made else kind
    return maker(**arguments)


def _count(conns: Ints, inlets: ArrayLike, outlets: ArrayLike, coords: Optional[ArrayLike]) -> int:
    """Voids of a network that does not say how many it has."""
    if coords is not None:
        return len(np.asarray(coords))
    counts = [int(conns.max(initial=-1)) + 1]
    for given in (inlets, outlets):
        array = np.asarray(given)
        if array.dtype.kind == "b":
            counts.append(array.size)
        elif array.dtype.kind in "iu" and array.size:
            counts.append(int(array.max()) + 1)
    return max(counts)


def _side(pn: Mapping[str, object], given: Union[None, str, ArrayLike], name: str, labels: Sequence[str]) -> ArrayLike:
    """Pores of one side of a network, by label or as they are given."""
    if isinstance(given, str):
        labels = [given if given.startswith("pore.") else f"pore.{given}"]
    elif given is not None:
        return given
    for label in labels:
        if label in pn and np.asarray(pn[label]).any():
            return np.asarray(pn[label], dtype=bool)
    raise ValueError(f"{name}: the network has no pores labelled {', '.join(labels)}; give their numbers")
