// What a page takes of three.js. Bundled into three.min.js as the licence file beside it says.
export {
  BackSide, BufferAttribute, BufferGeometry, CanvasTexture, Color, DirectionalLight, DoubleSide, FrontSide, Group,
  HemisphereLight, LineBasicMaterial, LineSegments, Mesh, MeshBasicMaterial, MeshLambertMaterial, OrthographicCamera, Plane,
  Points, PointsMaterial, Raycaster, SRGBColorSpace, Scene, ShapeUtils, Spherical, Vector2, Vector3, WebGLRenderer,
} from "three";
export { OrbitControls } from "three/addons/controls/OrbitControls.js";
export { LineMaterial } from "three/addons/lines/LineMaterial.js";
export { LineSegments2 } from "three/addons/lines/LineSegments2.js";
export { LineSegmentsGeometry } from "three/addons/lines/LineSegmentsGeometry.js";
export { GLTFLoader } from "three/addons/loaders/GLTFLoader.js";
export { toCreasedNormals } from "three/addons/utils/BufferGeometryUtils.js";
