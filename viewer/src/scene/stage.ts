/** Renderer, camera, lights, ground. Draws when something has changed, and never otherwise. */
import {
    Box3,
    Color,
    DirectionalLight,
    HemisphereLight,
    Mesh,
    PCFShadowMap,
    PerspectiveCamera,
    PlaneGeometry,
    Scene,
    ShadowMaterial,
    Vector3,
    WebGLRenderer,
} from "three";
import { OrbitControls } from "three/addons/controls/OrbitControls.js";
import { theme, type Theme } from "../app/theme";
import { GroundGrid } from "./ground_grid";

/** Milliseconds a frame above which the picture is made cheaper. */
const SLOW_FRAME = 45;

const BACKGROUND: Record<Theme, { sky: string; grid: string; shadow: number }> = {
    light: { sky: "#eef1f4", grid: "#b9c1ca", shadow: 0.16 },
    dark: { sky: "#15191f", grid: "#39424d", shadow: 0.4 },
};

export class Stage {
    readonly scene = new Scene();
    readonly camera = new PerspectiveCamera(40, 1, 0.01, 200);
    readonly controls: OrbitControls;
    readonly renderer: WebGLRenderer;
    /** Called before each frame. */
    readonly beforeFrame: (() => void)[] = [];
    /** Called after each frame. */
    readonly afterFrame: (() => void)[] = [];
    frames = 0;
    lastFrameMs = 0;
    private scheduled = 0;
    private slowFrames = 0;
    private readonly sun = new DirectionalLight("#fff6ea", 2.1);
    private readonly grid = new GroundGrid();
    private readonly floor = new Mesh(new PlaneGeometry(1, 1), new ShadowMaterial({ depthWrite: false }));

    constructor(readonly element: HTMLElement) {
        this.renderer = new WebGLRenderer({ antialias: true, preserveDrawingBuffer: false, powerPreference: "high-performance" });
        this.renderer.setPixelRatio(Math.min(devicePixelRatio, 2));
        this.renderer.shadowMap.enabled = true;
        this.renderer.shadowMap.type = PCFShadowMap;
        this.renderer.shadowMap.autoUpdate = false;
        const canvas = this.renderer.domElement;
        canvas.tabIndex = 0;
        canvas.setAttribute("role", "img");
        canvas.setAttribute("aria-label", "The scene in three dimensions. Drag to turn, right drag or two fingers to move, wheel to zoom.");
        element.append(canvas);
        this.camera.up.set(0, 0, 1);
        this.camera.position.set(2, -2, 1.5);
        this.controls = new OrbitControls(this.camera, canvas);
        this.controls.zoomToCursor = true;
        this.controls.addEventListener("change", () => this.invalidate());
        this.light();
        this.scene.add(this.grid.mesh, this.floor);
        new ResizeObserver(() => this.resize()).observe(element);
        theme.watch((value) => this.paint(value));
    }

    /** Asks for a frame; many calls are one frame. */
    invalidate(shadows = false): void {
        if (shadows) this.renderer.shadowMap.needsUpdate = true;
        if (!this.scheduled) this.scheduled = requestAnimationFrame(() => this.draw());
    }

    draw(): void {
        cancelAnimationFrame(this.scheduled);
        this.scheduled = 0;
        const before = performance.now();
        for (const call of this.beforeFrame) call();
        this.renderer.render(this.scene, this.camera);
        this.frames += 1;
        this.lastFrameMs = performance.now() - before;
        for (const call of this.afterFrame) call();
        this.cheapen();
    }

    /** Ground, shadows and clipping planes for a scene of this size. */
    setBounds(bounds: Box3): void {
        const size = bounds.isEmpty() ? 1 : bounds.getSize(new Vector3()).length();
        const centre = bounds.isEmpty() ? new Vector3() : bounds.getCenter(new Vector3());
        const ground = !bounds.isEmpty() && (bounds.min.z < -0.05 || bounds.min.z > 0.5) ? bounds.min.z : 0;
        this.camera.near = size / 400;
        this.camera.far = size * 60;
        this.controls.maxDistance = size * 20;
        this.controls.minDistance = size / 200;
        this.layGround(centre, size, ground - 0.002);
        const reach = size * 0.75;
        this.sun.position.copy(centre).add(new Vector3(0.45, -0.6, 1.25).multiplyScalar(size));
        this.sun.target.position.copy(centre);
        const { camera } = this.sun.shadow;
        Object.assign(camera, { left: -reach, right: reach, top: reach, bottom: -reach, near: size * 0.05, far: size * 4 });
        camera.updateProjectionMatrix();
        this.invalidate(true);
    }

    setGround(on: boolean): void {
        this.grid.mesh.visible = this.floor.visible = on;
        this.invalidate();
    }

    private light(): void {
        const sky = new HemisphereLight("#ffffff", "#8d8a86", 1.55);
        sky.position.set(0, 0, 1);
        const back = new DirectionalLight("#dfe9ff", 0.7);
        back.position.set(-1, 1, 0.6);
        this.sun.castShadow = true;
        this.sun.shadow.mapSize.set(2048, 2048);
        this.sun.shadow.bias = -0.0006;
        this.sun.shadow.normalBias = 0.012;
        this.scene.add(sky, back, this.sun, this.sun.target);
    }

    private layGround(centre: Vector3, size: number, z: number): void {
        this.grid.lay(centre, size, z);
        this.floor.scale.setScalar(size * 4);
        this.floor.position.set(centre.x, centre.y, z - 0.001);
        this.floor.receiveShadow = true;
    }

    private paint(value: Theme): void {
        const { sky, grid, shadow } = BACKGROUND[value];
        this.scene.background = new Color(sky);
        this.grid.paint(grid);
        this.floor.material.opacity = shadow;
        this.invalidate();
    }

    private resize(): void {
        const { clientWidth, clientHeight } = this.element;
        if (clientWidth === 0 || clientHeight === 0) return;
        this.renderer.setSize(clientWidth, clientHeight, false);
        this.camera.aspect = clientWidth / clientHeight;
        this.camera.updateProjectionMatrix();
        // At once: a canvas of a new size is blank until it is drawn.
        this.draw();
    }

    /** Slow machines, such as those that render in software, give up shadows and then pixels. */
    private cheapen(): void {
        this.slowFrames = this.lastFrameMs > SLOW_FRAME ? this.slowFrames + 1 : 0;
        if (this.slowFrames < 4) return;
        this.slowFrames = 0;
        if (this.sun.castShadow) this.sun.castShadow = false;
        else if (this.renderer.getPixelRatio() > 1) this.renderer.setPixelRatio(1);
        this.invalidate();
    }
}
