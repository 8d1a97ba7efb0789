/** The three-dimensional view: stage, bodies, ghosts, features, roadmap, marks. */
import { Vector3 } from "three";
import type { Model } from "../app/model";
import { Roadmap } from "../motion/roadmap";
import { stateWords } from "../data/names";
import { Bodies } from "./bodies";
import { Cloud } from "./cloud";
import { FeaturesLayer } from "./features";
import { Geometries } from "./geometries";
import { Ghost } from "./ghosts";
import { Labels } from "./labels";
import { closestPair, markPoints } from "./marks";
import { Materials } from "./materials";
import { Picking } from "./picking";
import { Stage } from "./stage";
import { Views } from "./views";

export class View3d {
    readonly stage: Stage;
    readonly views: Views;
    readonly picking: Picking;
    readonly geometries: Geometries;
    readonly cloud: Cloud | null = null;
    readonly roadmap: Roadmap | null = null;

    constructor(element: HTMLElement, model: Model) {
        const { view } = model;
        this.stage = new Stage(element);
        const { scene } = this.stage;
        this.geometries = new Geometries(view, model.arrays);
        const materials = new Materials();
        const bodies = new Bodies(model, this.geometries, materials);
        scene.add(bodies.root);
        this.views = new Views(this.stage, model, bodies);
        const scale = Math.min(Math.max(this.views.bounds(false).getSize(new Vector3()).length(), 0.2), 4);
        const labels = new Labels(model, this.stage);
        new FeaturesLayer(model, bodies, labels, scale);
        for (const name of ["start", "goal"] as const) {
            const configuration = view[name];
            if (!configuration) continue;
            const ghost = new Ghost(model, bodies, this.geometries, configuration, materials[name]);
            scene.add(ghost.root);
            model.switches[name].watch((on) => ghost.show(on));
        }
        scene.add(closestPair(model, labels, scale * 0.003), markPoints(model, labels, scale * 0.004));
        this.picking = new Picking(this.stage, model, bodies, labels, scale);
        scene.add(this.picking.measurement.root);
        if (view.search && view.search.count > 0) {
            this.roadmap = new Roadmap(view, view.search, model.arrays);
            this.cloud = new Cloud(this.roadmap, scale * 0.009);
            scene.add(this.cloud.root);
            this.takeNodes(model, this.roadmap, this.cloud);
        }
        model.configuration.watch(() => this.stage.invalidate(true));
        model.mark.watch(() => this.stage.invalidate());
        model.switches.ground.watch((on) => this.stage.setGround(on));
        for (const toggled of Object.values(model.switches)) toggled.watch(() => this.stage.invalidate(true));
    }

    /** A click on a node shows its configuration. */
    private takeNodes(model: Model, roadmap: Roadmap, cloud: Cloud): void {
        model.switches.roadmap.watch((on) => (cloud.root.visible = on));
        this.picking.takers.push((ray) => {
            const node = cloud.root.visible ? cloud.hit(ray) : null;
            if (node === null) return false;
            const state = roadmap.stateOf(node);
            model.pose(roadmap.configuration(node), `Node ${node} of the roadmap${state === 0xffff ? "" : `: ${stateWords(model.view, state)}`}`);
            return true;
        });
    }
}
