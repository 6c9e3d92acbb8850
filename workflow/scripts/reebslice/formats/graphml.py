"""Multigraphs with attributes, and how GraphML tells them."""

from typing import NamedTuple

NAMESPACES = (
    'xmlns="http://graphml.graphdrawing.org/xmlns" xmlns:xsi="http://www.w3.org/2001/XMLSchema-instance" '
    'xsi:schemaLocation="http://graphml.graphdrawing.org/xmlns http://graphml.graphdrawing.org/xmlns/1.0/graphml.xsd"'
)
TYPES = {str: "string", int: "long", float: "double", bool: "boolean"}


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
            Nodes, edges, keys and attributes are those that networkx reads from
            :func:`graphml_text` with ``force_multigraph=True``.
        """
        import networkx

        graph = networkx.MultiGraph()
        graph.add_nodes_from(self.nodes.items())
        graph.add_edges_from((low, high, row["id"], row) for low, high, row in self.edges)
        return graph


def graphml_text(graph):
    """Write a graph as GraphML, byte for byte as networkx 3 writes it with ids from the attribute `id`.

    Parameters
    ----------
    graph : Graph
        Every node has an attribute.

    Returns
    -------
    str

    Raises
    ------
    KeyError
        An attribute is of a type that is not in `TYPES`.
    """
    keys, forms = {}, {}
    body = [f'<node id="{name}">\n{_data("node", row, keys, forms)}</node>\n' for name, row in graph.nodes.items()]
    for low, high, row in _by_node(graph):
        data = _data("edge", row, keys, forms)
        body.append(f'<edge source="{low}" target="{high}" id="{row["id"]}">\n{data}</edge>\n')
    head = (
        f'<key id="d{number}" for="{scope}" attr.name="{name}" attr.type="{TYPES[kind]}"/>\n'
        for (scope, name, kind), number in reversed(keys.items())
    )
    return "".join(
        (
            f"<?xml version='1.0' encoding='utf-8'?>\n<graphml {NAMESPACES}>",
            *head,
            '<graph edgedefault="undirected">',
            *body,
            "</graph></graphml>",
        )
    )


def _data(scope, row, keys, forms):
    """The attributes of one node or edge.

    keys : {(scope, name, type): number}, forms : the text around the values of
    rows that have the same names and types; both grow by what is new.
    """
    shape = scope, *row, *map(type, row.values())
    if shape not in forms:
        numbers = [keys.setdefault((scope, name, type(value)), len(keys)) for name, value in row.items()]
        forms[shape] = "".join(f'  <data key="d{number}">%s</data>\n' for number in numbers)
    return forms[shape] % tuple(_escape(value) if type(value) is str else value for value in row.values())


def _escape(text):
    return text.replace("&", "&amp;").replace("<", "&lt;").replace(">", "&gt;")


def _by_node(graph):
    """The edges by their earlier node, there by the first to each neighbour: parallel ones lie together."""
    place, first, order = {name: k for k, name in enumerate(graph.nodes)}, {}, []
    for number, (a, b, row) in enumerate(graph.edges):
        low, high = (a, b) if place[a] <= place[b] else (b, a)
        order.append((place[low], first.setdefault((low, high), number), number, low, high, row))
    return [edge[3:] for edge in sorted(order, key=lambda edge: edge[:3])]
