"""Points and lines as VTK's XML files of poly data, which ParaView and PyVista open.

Reference: K. Martin, W. Schroeder and others, VTK XML file formats,
https://docs.vtk.org/en/latest/vtk_file_formats/vtkxml_file_format.html
"""

import base64

import numpy as np

TYPES = {"f8": "Float64", "i4": "Int32", "i8": "Int64"}


def vtp_text(points, lines, line_data):
    """Write lines through points as a file of poly data, version 1.0, little-endian, uncompressed.

    Parameters
    ----------
    points : (n, 3) float64
    lines : Groups
        Points of each of L lines.
    line_data : dict of str to (L,) array
        Whole numbers or real ones, by name.

    Returns
    -------
    str
        The same numbers make the same text.

    Raises
    ------
    KeyError
        An array is of a type that is not in `TYPES`.
    """
    count = len(lines.start) - 1
    return "\n".join(
        [
            '<?xml version="1.0"?>',
            '<VTKFile type="PolyData" version="1.0" byte_order="LittleEndian" header_type="UInt64">',
            "<PolyData>",
            f'<Piece NumberOfPoints="{len(points)}" NumberOfVerts="0" NumberOfLines="{count}" NumberOfStrips="0" '
            'NumberOfPolys="0">',
            f"<Points>{_array('Points', np.asarray(points, np.float64), 3)}</Points>",
            f"<CellData>{''.join(_array(name, np.asarray(values)) for name, values in line_data.items())}</CellData>",
            f"<Lines>{_array('connectivity', lines.member.astype(np.int64))}"
            f"{_array('offsets', lines.start[1:].astype(np.int64))}</Lines>",
            "</Piece>",
            "</PolyData>",
            "</VTKFile>",
            "",
        ]
    )


def _array(name, values, width=1):
    """An array as an element, in base 64 behind the number of its bytes."""
    little = np.ascontiguousarray(values, values.dtype.newbyteorder("<"))
    coded = base64.b64encode(np.uint64(little.nbytes).astype("<u8").tobytes() + little.tobytes()).decode()
    kind = TYPES[little.dtype.str[1:]]
    return f'<DataArray type="{kind}" Name="{name}" NumberOfComponents="{width}" format="binary">{coded}</DataArray>'
