/** Materials, each made once a colour. */
import { Color, DoubleSide, LineBasicMaterial, MeshBasicMaterial, MeshLambertMaterial, type Material } from "three";
import { FAILURE } from "../app/colours";

export class Materials {
    private readonly solids = new Map<string, MeshLambertMaterial>();
    readonly collision = new MeshLambertMaterial({
        color: "#e08a1e",
        transparent: true,
        opacity: 0.3,
        depthWrite: false,
        side: DoubleSide,
    });
    readonly collisionEdges = new LineBasicMaterial({ color: "#a85a00", transparent: true, opacity: 0.75 });
    readonly missing = new MeshLambertMaterial({ color: "#8a8f98", transparent: true, opacity: 0.45, side: DoubleSide });
    readonly highlight = new MeshLambertMaterial({ color: FAILURE, emissive: FAILURE, emissiveIntensity: 0.35, side: DoubleSide });
    readonly highlightThrough = new MeshBasicMaterial({ color: FAILURE, transparent: true, opacity: 0.18, depthTest: false, depthWrite: false });
    readonly start = ghost("#2f6fb5");
    readonly goal = ghost("#d9861a");

    /** `alpha` below one is translucent. */
    solid(colour: Color, alpha: number): Material {
        const key = `${colour.getHexString()}/${alpha.toFixed(2)}`;
        let material = this.solids.get(key);
        if (!material) {
            // Winding of published meshes varies: both sides are drawn.
            material = new MeshLambertMaterial({ color: colour, side: DoubleSide });
            if (alpha < 0.99) Object.assign(material, { transparent: true, opacity: Math.max(alpha, 0.1), depthWrite: false });
            this.solids.set(key, material);
        }
        return material;
    }

    /** Visual geometry turns translucent while collision geometry is drawn over it. */
    fade(on: boolean): void {
        for (const material of this.solids.values()) {
            if (material.userData["opacity"] === undefined) {
                material.userData["opacity"] = material.opacity;
                material.userData["transparent"] = material.transparent;
            }
            material.transparent = on || (material.userData["transparent"] as boolean);
            material.opacity = (material.userData["opacity"] as number) * (on ? 0.72 : 1);
            material.needsUpdate = true;
        }
    }
}

function ghost(colour: string): MeshLambertMaterial {
    return new MeshLambertMaterial({ color: colour, transparent: true, opacity: 0.3, side: DoubleSide, emissive: colour, emissiveIntensity: 0.25 });
}
