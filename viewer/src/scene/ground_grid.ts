/** The grid on the ground: one square whose lines are as wide as a pixel at any distance and fade away from the scene. */
import { Color, DoubleSide, Mesh, PlaneGeometry, ShaderMaterial, type Vector3 } from "three";

const VERTEX = `
varying vec2 place;
void main() {
    vec4 world = modelMatrix * vec4(position, 1.0);
    place = world.xy;
    gl_Position = projectionMatrix * viewMatrix * world;
}`;

const FRAGMENT = `
uniform vec3 colour;
uniform vec2 centre;
uniform float cell;
uniform float reach;
varying vec2 place;
float lines(float size) {
    vec2 at = place / size;
    vec2 width = fwidth(at);
    vec2 away = abs(fract(at - 0.5) - 0.5) / max(width, vec2(1e-6));
    // Lines closer than pixels would shimmer.
    return (1.0 - min(min(away.x, away.y), 1.0)) * (1.0 - smoothstep(0.25, 0.6, max(width.x, width.y)));
}
void main() {
    float fade = 1.0 - smoothstep(0.35, 1.0, distance(place, centre) / reach);
    float alpha = max(0.45 * lines(cell), 0.9 * lines(5.0 * cell)) * fade;
    if (alpha < 0.01) discard;
    gl_FragColor = vec4(colour, alpha);
    #include <colorspace_fragment>
}`;

export class GroundGrid {
    private readonly material = new ShaderMaterial({
        vertexShader: VERTEX,
        fragmentShader: FRAGMENT,
        uniforms: { colour: { value: new Color() }, centre: { value: [0, 0] }, cell: { value: 0.1 }, reach: { value: 1 } },
        transparent: true,
        depthWrite: false,
        side: DoubleSide,
    });
    readonly mesh = new Mesh(new PlaneGeometry(1, 1), this.material);

    lay(centre: Vector3, size: number, z: number): void {
        const { uniforms } = this.material;
        uniforms["cell"]!.value = size > 12 ? 1 : size > 4 ? 0.5 : size > 1.2 ? 0.1 : 0.02;
        uniforms["reach"]!.value = 1.6 * size;
        uniforms["centre"]!.value = [centre.x, centre.y];
        this.mesh.scale.setScalar(3.2 * size);
        this.mesh.position.set(centre.x, centre.y, z);
    }

    paint(colour: string): void {
        (this.material.uniforms["colour"]!.value as Color).set(colour);
    }
}
