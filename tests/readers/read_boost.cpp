// Read all graphs with Boost.Graph, and hold numbers of nodes and edges, heights and labels against expected.json.
#include <boost/graph/adjacency_list.hpp>
#include <boost/graph/graphml.hpp>
#include <boost/property_tree/json_parser.hpp>
#include <boost/version.hpp>
#include <fstream>
#include <iostream>
#include <map>

int main(int count, char** folders) {
    using namespace boost;
    typedef adjacency_list<vecS, vecS, undirectedS> Graph;
    typedef graph_traits<Graph>::vertex_descriptor Vertex;
    for (int i = 1; i < count; ++i) {
        property_tree::ptree expected;
        property_tree::read_json(std::string(folders[i]) + "/expected.json", expected);
        for (const auto& [name, told] : expected.get_child("graphs")) {
            Graph graph;
            std::map<Vertex, double> height;
            std::map<Vertex, long> branches;
            std::map<Vertex, std::string> label;
            dynamic_properties wanted(ignore_other_properties);
            associative_property_map<std::map<Vertex, double>> heights(height);
            associative_property_map<std::map<Vertex, long>> flags(branches);
            associative_property_map<std::map<Vertex, std::string>> labels(label);
            wanted.property("height", heights).property("branches", flags).property("label", labels);
            std::ifstream file(std::string(folders[i]) + "/" + name + ".graphml");
            read_graphml(file, graph, wanted);
            bool same = num_vertices(graph) == told.get_child("ids").size();
            same = same && num_edges(graph) == told.get_child("edges").size();
            Vertex vertex = 0;
            for (const auto& [_, value] : told.get_child("heights"))
                same = same && height[vertex++] == value.get_value<double>();
            vertex = 0;
            for (const auto& [_, value] : told.get_child("branches"))
                same = same && branches[vertex++] == value.get_value<long>();
            vertex = 0;
            for (const auto& [_, value] : told.get_child("labels")) same = same && label[vertex++] == value.data();
            if (!same) {
                std::cerr << folders[i] << " " << name << " differs\n";
                return 1;
            }
        }
    }
    std::cout << "Boost " << BOOST_LIB_VERSION << "\n";
}
