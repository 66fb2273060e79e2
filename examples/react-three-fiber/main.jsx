import { Canvas, useFrame, useLoader } from '@react-three/fiber';
import { applyTransferAsync } from 'cagecast/three';
import { Suspense, useEffect } from 'react';
import { createRoot } from 'react-dom/client';
import { SRGBColorSpace, TextureLoader } from 'three';
import { GLTFLoader } from 'three/addons/loaders/GLTFLoader.js';

function PaintedHead({ paint: file }) {
  const [head, cage] = useLoader(GLTFLoader, ['target.glb', 'cage.glb']);
  const paint = useLoader(TextureLoader, file);

  useEffect(() => {
    paint.flipY = false; // textures of glTF begin at the top
    paint.colorSpace = SRGBColorSpace;
    const controller = new AbortController();
    let applied;
    applyTransferAsync(head, { cage, texture: paint, signal: controller.signal }).then(
      (made) => {
        applied = made;
        document.title = `${made.parts.length} painted`;
      },
      (error) => controller.signal.aborted || console.error(error),
    );
    return () => {
      controller.abort();
      applied?.dispose();
    };
  }, [head, cage, paint]);

  // The camera, not the head, which must stay where the cage is until it is painted.
  useFrame(({ camera, clock }) => {
    const turn = Math.sin(clock.elapsedTime / 2) / 2;
    camera.position.set(2.5 * Math.sin(turn), 0, 2.5 * Math.cos(turn));
    camera.lookAt(0, 0, 0);
  });
  return <primitive object={head.scene} />;
}

createRoot(document.querySelector('#root')).render(
  <Canvas camera={{ fov: 35, position: [0, 0, 2.5] }}>
    <ambientLight intensity={1.5} />
    <directionalLight intensity={2} />
    <Suspense>
      <PaintedHead paint="paint-tiger.png" />
    </Suspense>
  </Canvas>,
);
