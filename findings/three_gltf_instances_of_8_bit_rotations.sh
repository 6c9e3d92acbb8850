#!/usr/bin/env bash
# three.js: an instance whose rotation is stored in 8 bits, as EXT_mesh_gpu_instancing allows it, grows and shears.
#
# Run with node 20.20.2, three 0.187.0. The extension lets ROTATION be normalized bytes; a third of a turn about
# (1, 1, 1) is then 64, 64, 64, 64 or 0.504 for 0.5, of length 1.008. GLTFLoader composes the matrix of the instance
# from it as it is, without bringing it to length one, so that it is no rotation.
#
# Seen:   determinant of the instance with float rotation 1.0000, in 16 bits 1.0002, in 8 bits 1.0482
# Everything that is instanced with such a file is 4.8 % too large; a file of normalized shorts is 0.02 % off.
set -euo pipefail
folder=$(mktemp -d); trap 'rm -rf "$folder"' EXIT; cd "$folder"
npm init -y > package.log
npm install --silent --no-audit --no-fund three@0.187.0
cat > run.mjs <<'JS'
globalThis.self = globalThis;
globalThis.ProgressEvent ??= class extends Event {};
const { Matrix4, REVISION } = await import('three');
const { GLTFLoader } = await import('three/examples/jsm/loaders/GLTFLoader.js');
console.log(`node ${process.version}, three r${REVISION}`);

async function determinant(array, componentType) {
  const triangle = new Uint8Array(new Float32Array([0, 0, 0, 1, 0, 0, 0, 1, 0]).buffer);
  const data = Buffer.concat([triangle, new Uint8Array(array.buffer)]);
  const gltf = {
    asset: { version: '2.0' }, scene: 0, scenes: [{ nodes: [0] }],
    extensionsUsed: ['EXT_mesh_gpu_instancing'], extensionsRequired: ['EXT_mesh_gpu_instancing'],
    nodes: [{ mesh: 0, extensions: { EXT_mesh_gpu_instancing: { attributes: { ROTATION: 1 } } } }],
    meshes: [{ primitives: [{ attributes: { POSITION: 0 } }] }],
    accessors: [
      { bufferView: 0, componentType: 5126, count: 3, type: 'VEC3', min: [0, 0, 0], max: [1, 1, 0] },
      { bufferView: 1, componentType, normalized: componentType !== 5126, count: 1, type: 'VEC4' },
    ],
    bufferViews: [
      { buffer: 0, byteLength: 36, target: 34962 }, { buffer: 0, byteOffset: 36, byteLength: array.byteLength },
    ],
    buffers: [{ byteLength: data.length, uri: 'data:application/octet-stream;base64,' + data.toString('base64') }],
  };
  const { scene } = await new GLTFLoader().parseAsync(JSON.stringify(gltf), '');
  const matrix = new Matrix4();
  scene.traverse((object) => { if (object.isInstancedMesh) object.getMatrixAt(0, matrix); });
  return matrix.determinant();
}

const float = await determinant(new Float32Array([0.5, 0.5, 0.5, 0.5]), 5126);
const byte = await determinant(new Int8Array([64, 64, 64, 64]), 5120);
const short = await determinant(new Int16Array([16384, 16384, 16384, 16384]), 5122);
console.log(`determinant: float ${float.toFixed(4)}, 16 bits ${short.toFixed(4)}, 8 bits ${byte.toFixed(4)}`);
process.exit(Math.abs(float - 1) < 1e-6 && byte > 1.04 ? 0 : 1);
JS
node run.mjs
