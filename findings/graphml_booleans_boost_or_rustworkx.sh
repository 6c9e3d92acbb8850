#!/usr/bin/env bash
# GraphML: no spelling of a boolean is read by both Boost.Graph and rustworkx.
#
# XML Schema has four: true, false, 1, 0. Boost.Graph takes 1 and 0 alone, also for an attribute that the program did
# not ask for, and refuses the whole file otherwise: what networkx writes (True), and what the schema calls canonical
# (true), is no graph to it. rustworkx takes true and false alone and refuses what Boost itself writes. networkx and
# igraph read all of them. Who writes a graph for all readers has to store flags as whole numbers.
#
# Seen with Boost 1.81.0 (Debian 12, g++ 12.2), rustworkx 0.18.1, networkx 3.6.1, igraph 1.0.0 (Python 3.11):
#   true   boost: parse error: invalid value "true" for key flag of type boolean
#          rustworkx True, networkx True, igraph True
#   1      boost: reads it; rustworkx: Failed conversion to 'bool': provided string was not `true` or `false`
#          networkx True, igraph True
#   True   boost and rustworkx refuse it; networkx True, igraph True
# Exit status 0 while that is so, 1 if the behaviour changes.
set -euo pipefail
folder=$(mktemp -d); trap 'rm -rf "$folder"' EXIT; chmod 755 "$folder"; cd "$folder"
version=1.81.0-5+deb12u1
apt-get download "libboost1.81-dev=$version" "libboost-graph1.81-dev=$version" > apt.log 2>&1
for package in *.deb; do dpkg -x "$package" root; done
cat > read.cpp <<'CPP'
#include <boost/graph/adjacency_list.hpp>
#include <boost/graph/graphml.hpp>
#include <boost/version.hpp>
#include <fstream>
#include <iostream>
int main(int, char** argv) {
    boost::adjacency_list<boost::vecS, boost::vecS, boost::undirectedS> graph;
    boost::dynamic_properties none(boost::ignore_other_properties);
    std::ifstream file(argv[1]);
    try {
        boost::read_graphml(file, graph, none);
        std::cout << "reads it";
    } catch (const std::exception& fault) {
        std::cout << fault.what();
    }
    std::cout << " (Boost " << BOOST_LIB_VERSION << ")\n";
}
CPP
g++ -w -std=c++17 -I root/usr/include read.cpp root/usr/lib/*/libboost_graph.a -o read_boost
python3 -m venv venv
venv/bin/pip install --quiet rustworkx==0.18.1 networkx==3.6.1 igraph==1.0.0
cat > check.py <<'PYTHON'
import subprocess
import sys

import igraph
import networkx
import rustworkx

TEXT = """<?xml version="1.0" encoding="UTF-8"?>
<graphml xmlns="http://graphml.graphdrawing.org/xmlns">
<key id="d0" for="node" attr.name="flag" attr.type="boolean"/>
<graph id="G" edgedefault="undirected"><node id="a"><data key="d0">{}</data></node><node id="b"><data key="d0">{}</data></node>
<edge source="a" target="b"/></graph></graphml>
"""
READERS = {
    "rustworkx": lambda path: [node["flag"] for node in rustworkx.read_graphml(path)[0].nodes()],
    "networkx": lambda path: [flag for _, flag in networkx.read_graphml(path).nodes(data="flag")],
    "igraph": lambda path: igraph.Graph.Read_GraphML(path).vs["flag"],
}
found = {}
for words in (("true", "false"), ("1", "0"), ("True", "False")):
    with open("graph.graphml", "w") as file:
        file.write(TEXT.format(*words))
    said = subprocess.run(["./read_boost", "graph.graphml"], capture_output=True, text=True).stdout.strip()
    print(words[0], "boost:", said)
    found[words[0], "boost"] = said.startswith("reads it")
    for name, read in READERS.items():
        try:
            said = read("graph.graphml")
        except Exception as fault:
            said = fault
        print(words[0], f"{name}:", said)
        found[words[0], name] = said == [True, False]
takes = {name: [word for word in ("true", "1", "True") if found[word, name]] for name in ("boost", *READERS)}
print(takes)
every = ["true", "1", "True"]
sys.exit(takes != {"boost": ["1"], "rustworkx": ["true"], "networkx": every, "igraph": every})
PYTHON
venv/bin/python check.py
