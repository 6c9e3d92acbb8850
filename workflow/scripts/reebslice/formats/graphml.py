"""Multigraphs with attributes, and how GraphML tells them."""

import itertools
from typing import NamedTuple

NAMESPACES = (
    'xmlns="http://graphml.graphdrawing.org/xmlns" xmlns:xsi="http://www.w3.org/2001/XMLSchema-instance" '
    'xsi:schemaLocation="http://graphml.graphdrawing.org/xmlns http://graphml.graphdrawing.org/xmlns/1.0/graphml.xsd"'
)
TYPES = {str: "string", int: "long", float: "double", bool: "long"}


class Graph(NamedTuple):
    """An undirected multigraph.

    Attributes
    ----------
    nodes : dict
        Attributes of every node by its name.
    edges : list of (str, str, dict)
        Names of both ends, and attributes. The attribute `id` is the edge's id
        in GraphML, too. Attributes map words to str, int, float or bool.
    """

    nodes: dict
    edges: list

    def to_networkx(self):
        """Convert to networkx.

        Returns
        -------
        networkx.MultiGraph
            Nodes, edges, keys and attributes equal those that networkx reads from
            :func:`graphml_text` with ``force_multigraph=True``.
        """
        import networkx

        graph = networkx.MultiGraph()
        graph.add_nodes_from(self.nodes.items())
        graph.add_edges_from((low, high, row["id"], row) for low, high, row in self.edges)
        return graph


def graphml_text(graph, name, about):
    """Write a graph as GraphML that readers of all kinds take: no gaps, numbers as XML Schema spells them.

    Parameters
    ----------
    graph : Graph
        All nodes have the same attributes in one order, and so have all edges; an attribute is of one type.
    name : str
        The id of the graph in the document.
    about : dict
        Attributes of the graph as a whole: words to str, int, float or bool.

    Returns
    -------
    str
        The same graph makes the same text. The document has one key per attribute, and an edge its attribute
        `id` as its id. NaN, which stands for an unknown number, is a valid double. False and true are the whole
        numbers 0 and 1: of the spellings of a GraphML boolean Boost takes no other, and rustworkx not these.

    Raises
    ------
    KeyError
        An attribute is of a type that is not in `TYPES`.
    ValueError
        A node or edge has other attributes than the first one, or of other types.
    """
    edges = _by_node(graph)
    keys, forms = {}, {}
    for scope, row in (("graph", about), *_first("node", graph.nodes.values()), *_first("edge", (e[2] for e in edges))):
        numbers = [keys.setdefault((scope, word, type(value)), len(keys)) for word, value in row.items()]
        forms[scope] = tuple(map(type, row.values())), tuple(row), [f'  <data key="d{n}">%s</data>\n' for n in numbers]
    head = (
        f'<key id="d{number}" for="{scope}" attr.name="{word}" attr.type="{TYPES[kind]}"/>\n'
        for (scope, word, kind), number in keys.items()
    )
    nodes = (f'<node id="{node}">\n{_data(row, *forms["node"])}</node>\n' for node, row in graph.nodes.items())
    links = (
        f'<edge id="{row["id"]}" source="{low}" target="{high}">\n{_data(row, *forms["edge"])}</edge>\n'
        for low, high, row in edges
    )
    whole = f'<graph id="{name}" edgedefault="undirected">\n{_data(about, *forms["graph"])}'
    start = f'<?xml version="1.0" encoding="UTF-8"?>\n<graphml {NAMESPACES}>\n'
    return "".join((start, *head, whole, *nodes, *links, "</graph>\n</graphml>\n"))


def _first(scope, rows):
    """The first of some rows with its scope, in a list; an empty one of none."""
    return [(scope, row) for row in itertools.islice(rows, 1)]


def _data(row, types, names, lines):
    """The attributes of one node or edge, which must have these names and types; lines : the text around each."""
    if tuple(row) != names or tuple(map(type, row.values())) != types:
        raise ValueError(f"a graph's rows differ in their attributes: {row} has not those of the first one, {names}")
    return "".join(lines) % tuple(map(_tell, row.values()))


def _tell(value):
    """A value as XML Schema spells it."""
    if type(value) is str:
        return value.replace("&", "&amp;").replace("<", "&lt;").replace(">", "&gt;")
    if type(value) is bool:
        return int(value)
    return value if value == value else "NaN"


def _by_node(graph):
    """The edges by their earlier node, there by the first to each neighbour: parallel ones lie together."""
    place, first, order = {name: k for k, name in enumerate(graph.nodes)}, {}, []
    for number, (a, b, row) in enumerate(graph.edges):
        low, high = (a, b) if place[a] <= place[b] else (b, a)
        order.append((place[low], first.setdefault((low, high), number), number, low, high, row))
    return [edge[3:] for edge in sorted(order, key=lambda edge: edge[:3])]
