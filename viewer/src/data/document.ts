/** The document of a page, as `foliate view` writes it. Metres, radians, seconds; poses `a_from_b` are x y z qx qy qz qw; z is up. */

export type Vec3 = [number, number, number];
export type Pose = [number, number, number, number, number, number, number];
/** Red, green, blue, alpha in 0..1, sRGB. */
export type Rgba = [number, number, number, number];
/** Where an array begins in the binary part, in bytes. */
export type Offset = number;
/** Two indices of links. */
export type LinkPair = [number, number];
/** A configuration, or one that the document names. */
export type Where = "start" | "goal" | number[];

export interface ViewDocument {
    format: string;
    title: string;
    kind: "path" | "scene" | "model" | "search";
    warnings?: string[] | null;
    /** How far shown meshes are from those of the files at most; triangles of the files, and shown. */
    deviation?: number | null;
    triangles?: [number, number] | null;
    /** What is shown where there is no start. */
    neutral?: number[] | null;
    facts?: [string, string][] | null;
    meshes: MeshData[];
    parts: { name: string; kind: "robot" | "object" | "environment" }[];
    links: Link[];
    joints: Joint[];
    coordinates: string[];
    documents?: Features | null;
    pairs?: LinkPair[] | null;
    start?: number[] | null;
    goal?: number[] | null;
    graph?: Graph | null;
    path?: PathData | null;
    collisions?: Collision[] | null;
    violations?: Violation[] | null;
    search?: SearchData | null;
}

/** Vertices as 3 × uint16 between `min` and `max`, triangles as 3 × uint16 (uint32 where `wide`). */
export interface MeshData {
    name: string;
    vertices: number;
    triangles: number;
    min: Vec3;
    max: Vec3;
    positions: Offset;
    indices: Offset;
    wide: boolean;
}

/** Full sides of a box; radius; radius and length along z. */
export type Shape =
    | { mesh: number }
    | { box: Vec3 }
    | { sphere: number }
    | { cylinder: [number, number] }
    | { capsule: [number, number] };

export interface Link {
    name: string;
    part: number;
    joint: number | null;
    joint_from_link: Pose;
    visual: { shape: Shape; pose: Pose; color?: Rgba | null; missing?: string | null }[];
    collision: { shape: Shape; pose: Pose; missing?: string | null }[];
}

export interface Joint {
    name: string;
    part: number;
    parent: number | null;
    parent_from_joint: Pose;
    type: "revolute" | "prismatic" | "planar" | "freeflyer";
    axis?: Vec3 | null;
    /** First number in a configuration and in a velocity; absent for followers. */
    q?: number | null;
    v?: number | null;
    leader?: number | null;
    multiplier?: number | null;
    offset?: number | null;
    lower?: (number | null)[] | null;
    upper?: (number | null)[] | null;
    velocity?: number | null;
}

interface Feature {
    name: string;
    link: number;
    pose: Pose;
}

export interface Features {
    grippers?: Feature[] | null;
    handles?: (Feature & { approach?: Vec3 | null; mask?: boolean[] | null })[] | null;
    surfaces?: (Feature & { kind: string; polygon: Vec3[] })[] | null;
}

export interface GraphState {
    id: number | string;
    name: string;
    words?: string | null;
    x: number;
    y: number;
    w: number;
    h: number;
    passed_through?: boolean | null;
    lines?: string[] | null;
}

export interface GraphTransition {
    id: number | string;
    from: number;
    to: number;
    name: string;
    words?: string | null;
    kind: "loop" | "regular" | "crossed";
    points: [number, number][];
    tried?: number | null;
    succeeded?: number | null;
    waypoints?: string[] | null;
}

export interface Graph {
    width: number;
    height: number;
    states: GraphState[];
    transitions: GraphTransition[];
    /** Words beside lines, and boxes of waypoints (`w` is 0 where there is no box), by their middle. */
    marks?: { words: string; x: number; y: number; w: number; h: number }[] | null;
    left_out?: string | null;
}

export interface Segment {
    from: number;
    to: number;
    state: number | null;
    transition?: number | null;
    words: string;
    /** What it ends at, where that is a waypoint of its transition. */
    waypoint?: string | null;
    colour: number;
    /** Who holds what: gripper and handle. */
    held?: [string, string][] | null;
}

export interface PathEvent {
    time: number;
    /** How long everything stands still from then on, seconds. */
    dwell?: number | null;
    kind: string;
    words: string;
    gripper?: string | null;
    handle?: string | null;
}

export interface PathData {
    timed: boolean;
    duration: number;
    times: Offset;
    configurations: Offset;
    samples: number;
    segments: Segment[];
    events?: PathEvent[] | null;
    clearance?: {
        times: Offset;
        values: Offset;
        samples: number;
        pairs: LinkPair[];
        pair: Offset;
        points: Offset;
    } | null;
    velocities?: Offset | null;
    /** Of a check: proved, refused, relative, undecided. */
    verdict?: string | null;
    refused?: { time?: number | null; words: string; links?: LinkPair | null }[] | null;
}

export interface Collision {
    configuration: Where;
    links: LinkPair;
    depth?: number | null;
    /** Where they are apart, and too close. */
    distance?: number | null;
    point?: Vec3 | null;
    points?: [Vec3, Vec3] | null;
    words: string;
}

export interface Violation {
    configuration: Where;
    words: string;
    value?: number | null;
    limit?: number | null;
    links?: number[] | null;
    /** Where an object is and where it would have to be. */
    points?: [Vec3, Vec3] | null;
    /** By which angle it would have to be turned besides. */
    angle?: number | null;
}

export interface FunnelPair {
    links: LinkPair;
    count: number;
    configuration?: number[] | null;
    depth?: number | null;
}

export interface FunnelRow {
    transition?: number | null;
    words?: string | null;
    tried: number;
    projected: number;
    free: number;
    reached: number;
    pairs?: FunnelPair[] | null;
}

export interface SearchData {
    nodes: Offset;
    count: number;
    tree: Offset;
    state: Offset;
    step: Offset;
    edges: Offset;
    edge_count: number;
    trees?: string[] | null;
    outcome?: string | null;
    words?: string[] | null;
    funnel?: FunnelRow[] | null;
}
