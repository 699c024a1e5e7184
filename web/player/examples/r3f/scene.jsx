/** A forest as a component. Trees are clicked like any object of react-three-fiber. */
import { Canvas, useFrame } from "@react-three/fiber";
import { Forest, PRESETS } from "galewood/three";
import { StrictMode, useEffect, useState } from "react";
import { createRoot } from "react-dom/client";
import { Matrix4 } from "three";

function Trees({ files, places, wind, ...props }) {
  const [forest, setForest] = useState(null);
  useEffect(() => {
    const made = new Forest({ wind });
    const failed = (error) => error.name === "AbortError" || console.error(error); // disposed of meanwhile
    made.plant(files, places).then(() => setForest(made), failed);
    return () => {
      setForest(null);
      made.dispose();
    };
  }, [files, places, wind]);
  useFrame(({ camera }, dt_s) => forest?.update(dt_s, camera));
  return forest && <primitive object={forest} {...props} />;
}

const FILES = { table: "/trees/poplar.table", mesh: "/trees/poplar.glb" };
const PLACES = [-6, 0, 6].map((x) => new Matrix4().makeTranslation(x, 0, -Math.abs(x)));

function App() {
  const [tree, setTree] = useState(null);
  return (
    <>
      <Canvas
        shadows="percentage"
        camera={{ position: [3, 5, 23], fov: 46 }}
        onCreated={({ camera }) => camera.lookAt(0, 6, 0)}
        frameloop="always"
      >
        <hemisphereLight args={[0xcfe4ff, 0x6d7a4a, 2.2]} />
        <directionalLight args={[0xfff1d6, 3]} position={[14, 22, 12]} castShadow shadow-bias={-0.002}>
          <orthographicCamera attach="shadow-camera" args={[-22, 22, 22, -22, 0.5, 80]} />
        </directionalLight>
        <mesh rotation-x={-Math.PI / 2} receiveShadow>
          <planeGeometry args={[400, 400]} />
          <meshLambertMaterial color={0x7f9a52} />
        </mesh>
        <Trees
          files={FILES}
          places={PLACES}
          wind={PRESETS["autumn-gusts"]}
          onClick={({ instanceId }) => setTree(instanceId)}
        />
      </Canvas>
      {tree !== null && <output>Tree {tree}</output>}
    </>
  );
}

createRoot(document.getElementById("root")).render(
  <StrictMode>
    <App />
  </StrictMode>,
);
