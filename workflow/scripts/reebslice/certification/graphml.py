"""Graphs read back from GraphML as their users read them."""

from collections.abc import Callable
from typing import NamedTuple
from xml.parsers import expat

NAMESPACE = "http://graphml.graphdrawing.org/xmlns"
ELEMENTS = ("graphml", "key", "graph", "node", "edge", "data")
KINDS = {f"{NAMESPACE} {name}": name for name in ELEMENTS}  # by the names that expat tells
TYPES: dict[str, Callable] = {"string": str, "long": int, "double": float}


class ReadGraph(NamedTuple):
    """An undirected multigraph: nodes {name: attributes}, edges [(name, name, id, attributes)], its own attributes."""

    nodes: dict
    edges: list
    about: dict


def parse_graph(document):
    """Read a graph from GraphML.

    Parameters
    ----------
    document : bytes

    Returns
    -------
    ReadGraph
        Attributes have their declared names and types, as `networkx.read_graphml` tells them.

    Raises
    ------
    ValueError
        Unless the document holds one undirected graph and each node of it once, and nothing but elements of `ELEMENTS`,
        all of GraphML's own namespace: others a reader might take for nodes and edges as well.
    KeyError
        For an attribute that it does not declare, or an edge without ends or id.
    xml.parsers.expat.ExpatError
        If it is no XML.
    """
    reader = _Reader()
    # Whatever it declares, since not all encodings can be looked up; names are those of namespaces, not of prefixes.
    parser = expat.ParserCreate("utf-8", " ")
    parser.buffer_text = True
    parser.StartElementHandler, parser.EndElementHandler = reader.start, reader.end
    parser.CharacterDataHandler = reader.text.append
    parser.Parse(document, True)
    if reader.directions != ["undirected"]:
        raise ValueError(f"the document holds {len(reader.directions)} graphs, or one that is not undirected")
    nodes = dict(reader.nodes)
    if len(nodes) < len(reader.nodes):
        raise ValueError("the document holds some node twice")
    return ReadGraph(nodes, reader.edges, reader.about)


class _Reader:
    """What the document says, element by element; `data` is that of the node or edge being read, else of the graph."""

    def __init__(self):
        self.keys, self.directions, self.nodes, self.edges = {}, [], [], []
        self.data, self.text = {}, []
        self.about = self.data

    def start(self, name, attributes):
        element = KINDS.get(name)
        if element is None:
            raise ValueError(f"the document holds an element {name.rpartition(' ')[2]!r}, which is none of a graph")
        self.text.clear()
        if element == "data":
            self.name, self.cast = self.keys[attributes["key"]]
        elif element == "node":
            self.data = {}
            self.nodes.append((attributes["id"], self.data))
        elif element == "edge":
            self.data = {}
            self.edges.append((attributes["source"], attributes["target"], attributes["id"], self.data))
            self.directions += ["directed"] * (attributes.get("directed") == "true")
        elif element == "key":
            self.keys[attributes["id"]] = attributes["attr.name"], TYPES[attributes["attr.type"]]
        elif element == "graph":
            self.directions.append(attributes["edgedefault"])

    def end(self, name):
        element = KINDS[name]
        if element == "data":
            self.data[self.name] = self.cast("".join(self.text))
        elif element in ("node", "edge"):
            self.data = self.about
