export { AmbientLight, ArrowHelper, AxesHelper, BufferAttribute, BufferGeometry, BoxGeometry, Clock, Color, CylinderGeometry, ConeGeometry, DirectionalLight, DoubleSide, EdgesGeometry, GridHelper, Group, HemisphereLight, Line, LineBasicMaterial, LineDashedMaterial, LineSegments, Matrix4, Mesh, MeshLambertMaterial, MeshStandardMaterial, MeshPhongMaterial, PerspectiveCamera, OrthographicCamera, Quaternion, Raycaster, Scene, SphereGeometry, Sprite, SpriteMaterial, CanvasTexture, TorusGeometry, Vector3, WebGLRenderer, Box3, CapsuleGeometry, CircleGeometry, RingGeometry, PlaneGeometry, Points, PointsMaterial } from 'three';
export { OrbitControls } from 'three/examples/jsm/controls/OrbitControls.js';
export { Float32BufferAttribute, PCFShadowMap, ShadowMaterial, Spherical, SRGBColorSpace } from 'three';
export { Line2 } from 'three/examples/jsm/lines/Line2.js';
export { LineGeometry } from 'three/examples/jsm/lines/LineGeometry.js';
export { LineMaterial } from 'three/examples/jsm/lines/LineMaterial.js';
export { LineSegments2 } from 'three/examples/jsm/lines/LineSegments2.js';
export { LineSegmentsGeometry } from 'three/examples/jsm/lines/LineSegmentsGeometry.js';
