"""Points with lines or triangles as VTK's XML files of poly data, which ParaView and PyVista open.

Reference: K. Martin, W. Schroeder and others, VTK XML file formats,
https://docs.vtk.org/en/latest/vtk_file_formats/vtkxml_file_format.html
"""

import base64

import numpy as np

TYPES = {"f8": "Float64", "i4": "Int32", "i8": "Int64"}
KINDS = ("Verts", "Lines", "Strips", "Polys")


def vtp_text(points, cells, cell_data, point_data=None, facts=None, kind="Lines"):
    """Write cells through points as a file of poly data, version 1.0, little-endian, uncompressed.

    Parameters
    ----------
    points : (n, 3) float64
    cells : Groups
        Points of each of L cells.
    cell_data : dict of str to (L,) array
        Whole numbers or real ones, by name.
    point_data : dict of str to (n,) array
        The same of points.
    facts : dict of str to str
        Words about the whole, by name.
    kind : {"Lines", "Polys"}
        What the cells are.

    Returns
    -------
    str
        The same numbers make the same text.

    Raises
    ------
    KeyError
        An array is of a type that is not in `TYPES`.
    """
    counts = {each: len(cells.start) - 1 if each == kind else 0 for each in KINDS}
    numbers = " ".join(f'NumberOf{each}="{count}"' for each, count in counts.items())
    told = "".join(_words(name, text) for name, text in (facts or {}).items())
    return "\n".join(
        [
            '<?xml version="1.0"?>',
            '<VTKFile type="PolyData" version="1.0" byte_order="LittleEndian" header_type="UInt64">',
            "<PolyData>",
            *([f"<FieldData>{told}</FieldData>"] if told else []),
            f'<Piece NumberOfPoints="{len(points)}" {numbers}>',
            f"<Points>{_array('Points', np.asarray(points, np.float64), 3)}</Points>",
            *([f"<PointData>{_arrays(point_data)}</PointData>"] if point_data else []),
            f"<CellData>{_arrays(cell_data)}</CellData>",
            f"<{kind}>{_array('connectivity', cells.member.astype(np.int64))}"
            f"{_array('offsets', cells.start[1:].astype(np.int64))}</{kind}>",
            "</Piece>",
            "</PolyData>",
            "</VTKFile>",
            "",
        ]
    )


def _arrays(columns):
    """Arrays by name as elements."""
    return "".join(_array(name, np.asarray(values)) for name, values in columns.items())


def _array(name, values, width=1):
    """An array as an element, in base 64 behind the number of its bytes."""
    little = np.ascontiguousarray(values, values.dtype.newbyteorder("<"))
    coded = base64.b64encode(np.uint64(little.nbytes).astype("<u8").tobytes() + little.tobytes()).decode()
    kind = TYPES[little.dtype.str[1:]]
    return f'<DataArray type="{kind}" Name="{name}" NumberOfComponents="{width}" format="binary">{coded}</DataArray>'


def _words(name, text):
    """A text as an element: the numbers of its bytes, a 0 at the end."""
    codes = " ".join(map(str, (*text.encode(), 0)))
    return f'<Array type="String" Name="{name}" NumberOfTuples="1" format="ascii">{codes}</Array>'
