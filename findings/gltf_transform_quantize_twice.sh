#!/usr/bin/env bash
# glTF-Transform: quantize() of a mesh whose POSITION is already 8-bit, unsigned and normalized moves and halves it.
#
# Run with node 20.20.2, @gltf-transform/core and /functions 4.5.1. A cube is stored as KHR_mesh_quantization allows
# it, POSITION as normalized unsigned bytes 0 and 255, scaled by 10 by its node. quantize() writes a new transform
# into the node, as if the positions were remapped to -1 to 1, but leaves the bytes as they are.
#
# Seen:   before quantize  0 0 0 .. 10 10 10
#         after quantize   5 5 5 .. 10 10 10     (an eighth of the volume, no warning)
# The float cube beside it stays where it is, which is what one expects of both.
set -euo pipefail
folder=$(mktemp -d); trap 'rm -rf "$folder"' EXIT; cd "$folder"
npm init -y > package.log
npm install --silent --no-audit --no-fund @gltf-transform/core@4.5.1 @gltf-transform/functions@4.5.1 @gltf-transform/extensions@4.5.1
cat > run.mjs <<'JS'
import { Document } from '@gltf-transform/core';
import { KHRMeshQuantization } from '@gltf-transform/extensions';
import { getBounds, quantize } from '@gltf-transform/functions';
import { readFileSync } from 'fs';

const version = JSON.parse(readFileSync('node_modules/@gltf-transform/functions/package.json')).version;
console.log(`node ${process.version}, @gltf-transform/functions ${version}`);
const corners = [], triangles = [0,2,1, 1,2,3, 4,5,6, 5,7,6, 0,1,4, 1,5,4, 2,6,3, 3,6,7, 0,4,2, 2,4,6, 1,3,5, 3,7,5];
for (const z of [0, 1]) for (const y of [0, 1]) for (const x of [0, 1]) corners.push(x, y, z);

async function bounds(array, normalized) {
  const document = new Document(), buffer = document.createBuffer();
  if (normalized) document.createExtension(KHRMeshQuantization).setRequired(true);
  const position = document.createAccessor().setType('VEC3').setArray(array).setNormalized(normalized).setBuffer(buffer);
  const indices = document.createAccessor().setType('SCALAR').setArray(new Uint16Array(triangles)).setBuffer(buffer);
  const primitive = document.createPrimitive().setAttribute('POSITION', position).setIndices(indices);
  const node = document.createNode().setMesh(document.createMesh().addPrimitive(primitive)).setScale([10, 10, 10]);
  const scene = document.createScene().addChild(node);
  const tell = () => { const { min, max } = getBounds(scene); return `${min.map(Math.round).join(' ')} .. ${max.map(Math.round).join(' ')}`.replaceAll('-0', '0'); };
  const before = tell();
  await document.transform(quantize());
  return [before, tell()];
}

const bytes = await bounds(new Uint8Array(corners.map((c) => 255 * c)), true);
const floats = await bounds(new Float32Array(corners), false);
console.log(`normalized bytes: before ${bytes[0]}, after ${bytes[1]}`);
console.log(`floats:           before ${floats[0]}, after ${floats[1]}`);
const seen = bytes[0] === '0 0 0 .. 10 10 10' && bytes[1] === '5 5 5 .. 10 10 10' && floats[1] === floats[0];
process.exit(seen ? 0 : 1);
JS
node run.mjs
