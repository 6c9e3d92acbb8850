from . import errors as errors
from .certification.certificate import certify as certify
from .formats.mesh_file import MeshFile as MeshFile
from .formats.meshes import read_mesh as read_mesh
from .graphs.bodies import pocket_bodies as pocket_bodies
from .graphs.exact import ExactGraph as ExactGraph
from .graphs.exact import exact_graphs as exact_graphs
from .graphs.pockets import Pockets as Pockets
from .graphs.pockets import find_islands as find_islands
from .graphs.pockets import find_pockets as find_pockets
from .graphs.voids import void_reeb_graph as void_reeb_graph
from .mesh.inspection import inspect_surface as inspect_surface
from .morse.height_mesh import HeightMesh as HeightMesh
from .morse.height_mesh import height_mesh as height_mesh
from .morse.reeb_graph import ReebGraph as ReebGraph
from .morse.reeb_graph import surface_reeb_graph as surface_reeb_graph
from .schemas import SCHEMAS as SCHEMAS
from .slicing.contours import Contours as Contours
from .slicing.levels import uniform_heights as uniform_heights
from .slicing.refinement import slice_surface as slice_surface
from .slicing.regions import Regions as Regions
from .slicing.slices import Slices as Slices
from .slicing.slices import nested_blocks as nested_blocks
from .slicing.slices import nested_contours as nested_contours
from .tilt.choice import select_tilt as select_tilt

__version__: str
