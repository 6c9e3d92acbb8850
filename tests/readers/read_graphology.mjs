// Read all graphs with graphology.
import { readFileSync } from 'fs';
import { deepStrictEqual } from 'assert';
import graphology from 'graphology';
import graphml from 'graphology-graphml';

for (const folder of process.argv.slice(2)) {
  const expected = JSON.parse(readFileSync(`${folder}/expected.json`));
  for (const [name, told] of Object.entries(expected.graphs)) {
    const graph = graphml.parse(graphology.MultiGraph, readFileSync(`${folder}/${name}.graphml`, 'utf8'));
    deepStrictEqual(graph.nodes(), told.ids);
    for (const [word, values] of [['height', told.heights], ['branches', told.branches], ['label', told.labels]])
      deepStrictEqual(graph.mapNodes((node, data) => data[word]), values);
    const place = new Map(told.ids.map((id, k) => [id, k]));
    const edges = new Map(told.edges.map(([low, high, key]) => [key, [low, high]]));
    deepStrictEqual(graph.size, edges.size);
    graph.forEachEdge((key, data, source, target) => {
      const ends = [place.get(source), place.get(target)].sort((a, b) => a - b);
      deepStrictEqual(ends, edges.get(key));
    });
    deepStrictEqual([graph.getAttribute('model'), graph.getAttribute('id')], [expected.model, name]);
  }
}
const version = name => JSON.parse(readFileSync(new URL(`node_modules/${name}/package.json`, import.meta.url))).version;
console.log('graphology', version('graphology'), 'graphology-graphml', version('graphology-graphml'), 'node', process.version);
