import {
  Box3,
  DirectionalLight,
  Group,
  Mesh,
  type Object3D,
  PerspectiveCamera,
  PlaneGeometry,
  Scene,
  ShadowMaterial,
  Vector3,
} from 'three';
import type { Viewer } from '../view/viewer';

const kApart = 1; // metres between the viewer and the model
const kNear = 0.02; // metres: what is seen
const kFar = 200;
const kLamp = 2; // intensity of the light from above

/**
 * Shows the painted model in the viewer's room through the camera of the device: on the floor, as large as its file says. A tap on
 * the floor puts it there.
 * @throws DOMException if the browser refuses.
 */
export async function showInRoom(viewer: Viewer): Promise<void> {
  const session = await navigator.xr!.requestSession('immersive-ar', { requiredFeatures: ['local-floor'] });
  const { renderer, stage, studio } = viewer;
  const { xr } = renderer;
  const giveBack = viewer.lend();
  const scene = new Scene();
  scene.environment = studio.scene.environment;
  const place = new Group();
  place.scale.setScalar(1 / stage.object.scale.x);
  place.rotation.y = -stage.front;
  place.add(stage.object);
  const { light, floor } = putOnFloor(stage.model!.scene, place);
  scene.add(place, light, floor);
  const end = (): void => {
    xr.removeEventListener('sessionend', end);
    renderer.setAnimationLoop(null);
    xr.enabled = false;
    light.dispose();
    floor.geometry.dispose();
    floor.material.dispose();
    giveBack();
  };
  xr.addEventListener('sessionend', end);
  try {
    xr.enabled = true;
    xr.setReferenceSpaceType('local-floor');
    await xr.setSession(session);
    session.addEventListener('select', ({ frame, inputSource }) => {
      const pose = frame.getPose(inputSource.targetRaySpace, xr.getReferenceSpace()!);
      const spot = pose && floorSpot(pose.transform);
      if (spot) scene.position.set(spot.x, 0, spot.z - floor.position.z);
    });
    const camera = new PerspectiveCamera(50, 1, kNear, kFar); // the device says where it is
    renderer.setAnimationLoop(() => renderer.render(scene, camera));
  } catch (error) {
    end();
    await session.end().catch(() => {});
    throw error;
  }
}

/** Moves the model onto the floor in front of the viewer. @returns A light, and a floor below it that shows the shadow only. */
function putOnFloor(
  model: Object3D,
  place: Group,
): { light: DirectionalLight; floor: Mesh<PlaneGeometry, ShadowMaterial> } {
  place.updateMatrixWorld(true);
  const box = new Box3().setFromObject(model, true);
  const [middle, size] = [box.getCenter(new Vector3()), box.getSize(new Vector3())];
  place.position.set(-middle.x, -box.min.y, -middle.z - kApart - size.z / 2);
  const reach = size.length();
  const light = new DirectionalLight('white', kLamp);
  light.position.set(0.3 * reach, 2 * reach, -kApart);
  light.target.position.set(0, 0, -kApart - size.z / 2);
  light.castShadow = true;
  const { camera, mapSize } = light.shadow;
  mapSize.set(1024, 1024);
  camera.left = camera.bottom = -reach;
  camera.right = camera.top = reach;
  camera.near = 0.1 * reach;
  camera.far = 4 * reach;
  light.add(light.target);
  const floor = new Mesh(new PlaneGeometry(4 * reach, 4 * reach), new ShadowMaterial({ opacity: 0.3 }));
  floor.rotation.x = -Math.PI / 2;
  floor.position.copy(light.target.position);
  floor.receiveShadow = true;
  return { light, floor };
}

/** Where a ray meets the floor, if it does. */
function floorSpot({ matrix, position: { x, y, z } }: XRRigidTransform): { x: number; z: number } | undefined {
  // It points along its negative z axis.
  const [dx, dy, dz] = [-matrix[8]!, -matrix[9]!, -matrix[10]!];
  return dy < 0 ? { x: x - (dx * y) / dy, z: z - (dz * y) / dy } : undefined;
}
