"""The record of an inspection: what is known of a mesh, and the repairs that it took."""

from dataclasses import dataclass, field

from ..errors import NotASolidError

REPAIRS = ("merge", "duplicates", "split", "orient")


@dataclass
class Inspection:
    """What is known of a mesh; `dataclasses.asdict` makes it fit for JSON. None is what was not found out.

    Attributes
    ----------
    status : str
        "accepted" as it stands, "repaired" or "rejected".
    reason : str
        Why it is rejected: what is wrong, where, and the cure.
    repairs : list of str
        What was changed, in order.
    n_vertices, n_faces : int
    closed, manifold, oriented : bool
        Whether the mesh edges of the file have two faces or more, two or less, and faces wound alike.
    components, genus, euler_characteristic, voids : int
        Of the canonical surface, summed over its shells.
    tolerance : float
        The tolerance within which corners were merged, relative to the largest extent.
    area, volume : float
        Mesh units squared and cubed, summed over the shells.
    bounds : list of two lists of three floats
        The lowest and the highest coordinates, mesh units.
    collinear_faces : int
        Faces whose three corners are in line; they stay.
    degenerate_faces_removed, duplicate_faces_removed, pinch_vertices_split : int
    self_crossings, body_crossings : int
        Pairs of faces that cross, see `face_pairs`: of one body, and of two.
    crossing_places : list of dict
        Of the first pairs of either kind the `faces` (rows of the table), their `bodies` and a `point` where they meet.
    crossings : str
        A sentence on these, empty where there are none.
    """

    status: str | None = None
    reason: str | None = None
    repairs: list[str] = field(default_factory=list)
    n_vertices: int | None = None
    n_faces: int | None = None
    closed: bool | None = None
    manifold: bool | None = None
    oriented: bool | None = None
    components: int | None = None
    genus: int | None = None
    euler_characteristic: int | None = None
    voids: int | None = None
    tolerance: float | None = None
    area: float | None = None
    volume: float | None = None
    bounds: list[list[float]] | None = None
    collinear_faces: int | None = None
    degenerate_faces_removed: int | None = None
    duplicate_faces_removed: int | None = None
    pinch_vertices_split: int | None = None
    self_crossings: int | None = None
    body_crossings: int | None = None
    crossing_places: list[dict] = field(default_factory=list)
    crossings: str = ""

    def reject(self, reason):
        """Note that the mesh is rejected, and why."""
        self.status, self.reason = "rejected", str(reason)

    def note_repair(self, repair, told, allowed):
        """Note a repair, of the kind `repair` out of `REPAIRS`; raises `NotASolidError` unless it is allowed."""
        if repair not in allowed:
            raise NotASolidError(
                f"It would take a repair that the configuration does not allow ({told});"
                f" add {repair} to inspect.repair, or mend the mesh in an editor."
            )
        self.repairs.append(told)
