/** Types and limits of the REST interface, from its OpenAPI description by `make page-types`. */

export interface Schemas {
  /** Settings of a build. Missing import options are those of the tree. */
  BuildSettings: {
    /** Wood species; default: guessed from the names. */
    species?: string | null;
    /** Height of the tree, m. */
    height_m?: number | null;
    /** Axis that points up; -z: z points down. */
    up_axis?: "x" | "y" | "z" | "-x" | "-y" | "-z" | null;
    /**
     * What is wood: names of materials, nodes or meshes, or ids of pieces. If a name is given, all parts that
     * are not named are leaves; ids change only their own pieces.
     */
    wood_parts?: string[] | null;
    /** What is leaves: names, or ids of pieces. */
    leaves?: string[] | null;
    /** What is left out, such as ground: names, or ids of pieces. */
    drop?: string[] | null;
    /** Which tree of a file with several, as numbered in the report; default: the largest. */
    tree?: number | null;
    /** Scanned tree: scale all radii to this diameter of the trunk at 1.3 m, cm. */
    dbh_cm?: number | null;
    /** Scanned tree: drop branches thinner than this, mm; default: 10, or what leaves 200. */
    min_radius_mm?: number | null;
    /** Scanned tree: add leaves at the ends of branches to the mesh; default: they are added. */
    add_leaves?: boolean | null;
    /**
     * Whether wood is added where foliage has none: a trunk inside a closed crown, ribs of fronds, stems of a
     * bush. It bends, but is not drawn. Default: where the foliage needs it.
     */
    complete?: boolean | null;
    /**
     * Accept what the import found without asking: what is left out, uncertain pieces, the up axis, the size.
     */
    accept?: boolean | null;
    /** Number of tetrahedra to aim at. */
    target_tets?: number;
    /** Elements sampled for the paper's state search. */
    sampled_elements?: number;
    /** Strongest wind of the runs for the paper's search, m/s. */
    design_speed_m_s?: number;
    /** Frames of each of the paper's cosine winds. */
    frames?: number;
    /** Seed of the training winds. */
    seed?: number;
    /** Oscillators of the modal model; default: 24. */
    modes?: number | null;
    /** Compute the records of the paper's method after the table. */
    paper?: boolean;
    /**
     * Simulate the tree in leaf or bare: the mesh keeps its leaves, which weigh nothing and catch no wind.
     */
    foliage?: "leaf" | "bare";
    /** Also compute a table of the same tree without its leaves, for the winter. */
    bare_table?: boolean;
    /** Record all 36 cosine winds of the paper instead of 18. */
    all_cosine_winds?: boolean;
    /** Rotational stiffness of the root plate, kN·m/rad; default: rigid ground. */
    root_stiffness_knm?: number | null;
    /**
     * visible: a stylised tree whose motion would be barely visible gets softer wood, with the first
     * frequency of real trees of its height; scanned trees keep that of their wood. as drawn: the stiffness
     * of the wood.
     */
    stiffness?: "visible" | "as drawn";
    /**
     * Scale the stiffness of the wood so that the tree has this first natural frequency, Hz; default: as
     * stiffness says.
     */
    first_frequency_hz?: number | null;
    /**
     * Scale the stiffness of the wood so that a steady wind of 18 m/s bends the tree by this share of its
     * height; default: as stiffness says.
     */
    sway?: number | null;
    /** Custom wood properties; they take precedence over the species. */
    wood?: Schemas["WoodDocument"] | null;
  };
  /** A comparison job: its settings and, once it is done, the largest errors and the URL of the tracks. */
  ComparisonOut: {
    id: string;
    tree_id: string;
    state: "queued" | "running" | "done" | "failed" | "cancelled";
    stage: string;
    fraction: number;
    message: string;
    seconds_left: number | null;
    error: string | null;
    settings: Record<string, unknown>;
    result: Record<string, unknown> | null;
    created_at: string;
    updated_at: string;
    tracks: string | null;
  };
  /**
   * Body of POST /api/trees/{id}/comparisons: a wind document (spec/formats/wind.md) or the state of a wind
   * transition, the tree's position and rotation, the start time and the number of frames.
   */
  ComparisonRequest: {
    wind: Record<string, unknown>;
    x_m?: number;
    z_m?: number;
    yaw_rad?: number;
    start_s?: number;
    frames?: number;
  };
  /**
   * The evaluations of a tree, newest first. Only the newest are kept. `damaged`: ids of records that cannot
   * be read and are left out; `total` counts them.
   */
  EvaluationList: {
    evaluations: Schemas["EvaluationOut"][];
    total: number;
    damaged: string[];
  };
  /**
   * An evaluation job: its settings and, once it is done, the main figures in gusts and in uniform winds
   * (`result`) and the URLs of the full report (`report`) and of the error plot (`plot`).
   */
  EvaluationOut: {
    id: string;
    tree_id: string;
    state: "queued" | "running" | "done" | "failed" | "cancelled";
    stage: string;
    fraction: number;
    message: string;
    seconds_left: number | null;
    error: string | null;
    settings: Record<string, unknown>;
    result: Record<string, unknown> | null;
    created_at: string;
    updated_at: string;
    report: string | null;
    plot: string | null;
  };
  /**
   * Body of POST /api/trees/{id}/evaluations. The tree is evaluated in gusts that differ within its crown,
   * then in winds that are the same over the whole crown. Their strength is given by sway; or that of the
   * uniform winds by their peak speed, by default 0.65 of the table's design speed.
   */
  EvaluationRequest: {
    /** Sway of the tree under each wind, as a fraction of its height. */
    sway?: number | null;
    /** Peak speed of each uniform wind. */
    speed_m_s?: number | null;
    /** Frames per wind, 1/30 s each. */
    frames?: number;
    /** Seed of the winds, their gusts, and the tree's place. */
    seed?: number;
  };
  /** Which individuals are here, and whether this server could grow the others. */
  FoundIndividuals: {
    /** Those asked for, in their order; null: it is not here, or not made yet. */
    trees: (Schemas["TreeSummary"] | null)[];
    /** Why this server grows no trees; null: it can. */
    cannot_grow: string | null;
  };
  /** Response of /healthz. */
  Health: {
    status: string;
    version: string;
    trees: number;
    ready: number;
    jobs_active: number;
    sockets: number;
  };
  /** Petterson's curve h = 1.3 m + (d / (a + b d))³, fitted to measured pairs. */
  HeightCurve: {
    species: string;
    a: number;
    b: number;
    pairs: number;
    residual_m: number;
  };
  /** Body of POST /api/individuals. */
  IndividualOrder: {
    /** The branches follow from this whole number. */
    seed: number;
    /** Height of the topmost leaf, m. */
    height_m: number;
    /** Diameter of the stem at breast height (1.3 m), cm; default: in proportion to height. */
    dbh_cm?: number | null;
    /** Grown in the open, or in a closed forest: slender with a high crown. */
    form?: "open" | "forest";
    /** Take the nearest size that the species can have; otherwise other sizes are refused. */
    nearest_size?: boolean;
    /** A built-in species: oak, spruce, ... */
    species: string;
  };
  /** The stems of an inventory (spec/formats/inventory.md), and how its file was interpreted. */
  InventoryOut: {
    version: 1;
    stems: Schemas["Stem"][];
    report: Schemas["InventoryReport"];
  };
  /** How the file was interpreted. */
  InventoryReport: {
    columns: Record<string, string>;
    rows: number;
    stems: number;
    skipped: number;
    first_skipped: Schemas["Skipped"][];
    substitutes: Schemas["Substitute"][];
    width_m: number;
    depth_m: number;
    lowest_m: number;
    highest_m: number;
    per_ha: number;
    estimated_heights: number;
    height_curves: Schemas["HeightCurve"][];
    figures: Record<string, string>;
    notes: string[];
  };
  /** A page of the jobs, newest first. */
  JobList: {
    total: number;
    next: string | null;
    damaged: string[];
    jobs: Schemas["JobOut"][];
  };
  /**
   * A build job: `fraction` is in [0, 1], `seconds_left` is an estimate, `error` a message for users.
   * `samples_done` of `samples_total` runs are simulated; `pictures` maps names of preview images to hashes.
   */
  JobOut: {
    id: string;
    tree_id: string;
    state: "queued" | "running" | "done" | "failed" | "cancelled";
    stage: string;
    fraction: number;
    message: string;
    seconds_left: number | null;
    samples_done?: number | null;
    samples_total?: number | null;
    pictures?: Record<string, string>;
    error: string | null;
    created_at: string;
    updated_at: string;
  };
  /** Body of POST /api/jobs. */
  JobRequest: {
    tree_id: string;
    settings?: Schemas["BuildSettings"];
  };
  /** Where the largest strains are; null: the tree has no boughs of 4 cm. */
  LargestOut: {
    stem: Schemas["SectionOut"] | null;
    boughs: Schemas["SectionOut"] | null;
  };
  /** Response of /api/health: versions of the software, the table format and the stream protocol. */
  Liveness: {
    status: string;
    version: string;
    table_version: number;
    wire_version: number;
  };
  /** The wind document of a measurement (spec/formats/wind.md), and how its file was interpreted. */
  MeasuredWindOut: {
    wind: Record<string, unknown>;
    report: Schemas["MeasurementReport"];
  };
  /** How the file was interpreted. */
  MeasurementReport: {
    columns: Record<string, string>;
    rows: number;
    missing: number;
    implausible: number;
    unreadable: string[];
    duplicates: number;
    disordered: number;
    gaps: number;
    longest_gap_s: number;
    rate_hz: number;
    duration_s: number;
    used_rate_hz: number;
    used_start_s: number;
    used_s: number;
    loop_s: number;
    mean_speed_m_s: number;
    max_speed_m_s: number;
    from_deg: number;
    intensity: number;
    figures: Record<string, string>;
    notes: string[];
  };
  /** Response of /api/health/ready: `status` is "ok" or "unable". */
  Readiness: {
    status: string;
    version: string;
    checks: Record<string, boolean>;
  };
  /** A section of a stem or bough, and what it bears. */
  SectionOut: {
    height_m: number;
    x_m: number;
    z_m: number;
    diameter_cm: number;
    moment_nm: number;
    strain: number;
    stress_mpa: number;
  };
  /** Branches of a tree: points, the index of the point that each grows from (−1: the root), radii. */
  SkeletonOut: {
    points_m: [number, number, number][];
    parent: number[];
    radius_m: number[];
  };
  /** A row without a tree. */
  Skipped: {
    line: number;
    reason: string;
  };
  /** Body of POST /api/individuals/find. */
  SoughtIndividuals: {
    individuals: Schemas["IndividualOrder"][];
  };
  /** The stems of an inventory in wind, what was assumed, and what this is not (`caution`). */
  StandRiskOut: {
    options: Record<string, unknown>;
    stems_per_ha: number;
    mean_height_m: number;
    stems: Schemas["StemRiskOut"][];
    assumptions: string[];
    caution: string;
  };
  /** A tree of the inventory, placed relative to the middle of the plot. */
  Stem: {
    line: number;
    east_m: number;
    north_m: number;
    species: string;
    builtin: string;
    height_m: number;
    slender: boolean;
    dbh_cm?: number | null;
    height_estimated?: boolean;
  };
  /** A stem in wind. Winds are gusts at its top, m/s; null: it does not break up to 100 m/s. */
  StemRiskOut: {
    /** 1 breaks first. */
    rank: number;
    /** Of the stem in the inventory, from 0. */
    index: number;
    /** Of the stem in its file. */
    line: number;
    species: string;
    /** The built-in tree that stands for it. */
    tree: string;
    /** Species of the wood; `default`: average wood. */
    wood: string;
    east_m: number;
    north_m: number;
    lon_deg: number | null;
    lat_deg: number | null;
    height_m: number;
    /** Whether the height is not measured: from the diameter. */
    height_estimated: boolean;
    dbh_cm: number;
    /** Whether the diameter is not measured: the tree's proportions. */
    dbh_assumed: boolean;
    /** Less than half or more than twice as high, or as slender, as the tree. */
    rough: boolean;
    frequency_hz: number;
    edge_distance_m: number;
    /** Share of the load at the edge that it bears. */
    load_share: number;
    /** Where the wind blows: 0 to the east, 90 to the south. */
    direction_deg: number;
    sway_m: number;
    base_moment_knm: number;
    /** The largest of the stem. */
    strain: number;
    critical_m_s: number | null;
    /** 10 % of possible trees break in a weaker gust. */
    critical_low_m_s: number | null;
    /** 90 % of possible trees break in a weaker gust. */
    critical_high_m_s: number | null;
  };
  /** What was simulated of a tree: tetrahedra (indices of vertices) and skeleton; tree frame, y up. */
  StructureOut: {
    vertices_m: [number, number, number][];
    tets: [number, number, number, number][];
    skeleton: Schemas["SkeletonOut"];
  };
  /** A name in the file without a tree of its genus. */
  Substitute: {
    name: string;
    builtin: string;
    genus: string;
    stems: number;
  };
  /** A page of the current tables. */
  TableList: {
    total: number;
    next: string | null;
    damaged: string[];
    tables: Schemas["TableOut"][];
  };
  /** The metadata of a table (spec/formats/table.md). */
  TableMetadata: {
    sha256: string;
    metadata: Record<string, unknown>;
  };
  /**
   * The current table of a tree; `records_sha256` is the file of the paper's records, once it exists, and
   * `bare_table_sha256` the table of the same mesh without its leaves, if there is one.
   */
  TableOut: {
    sha256: string;
    size_bytes: number;
    bare_table_sha256?: string | null;
    records_sha256: string | null;
    tree_id: string;
    name: string;
    species: string | null;
    height_m: number | null;
    mesh_sha256: string | null;
  };
  /** Body of PATCH /api/trees/{id}: a new name or other import options (the mesh is then imported again). */
  TreeChanges: {
    /** Wood species; default: guessed from the names. */
    species?: string | null;
    /** Height of the tree, m. */
    height_m?: number | null;
    /** Axis that points up; -z: z points down. */
    up_axis?: "x" | "y" | "z" | "-x" | "-y" | "-z" | null;
    /**
     * What is wood: names of materials, nodes or meshes, or ids of pieces. If a name is given, all parts that
     * are not named are leaves; ids change only their own pieces.
     */
    wood_parts?: string[] | null;
    /** What is leaves: names, or ids of pieces. */
    leaves?: string[] | null;
    /** What is left out, such as ground: names, or ids of pieces. */
    drop?: string[] | null;
    /** Which tree of a file with several, as numbered in the report; default: the largest. */
    tree?: number | null;
    /** Scanned tree: scale all radii to this diameter of the trunk at 1.3 m, cm. */
    dbh_cm?: number | null;
    /** Scanned tree: drop branches thinner than this, mm; default: 10, or what leaves 200. */
    min_radius_mm?: number | null;
    /** Scanned tree: add leaves at the ends of branches to the mesh; default: they are added. */
    add_leaves?: boolean | null;
    /**
     * Whether wood is added where foliage has none: a trunk inside a closed crown, ribs of fronds, stems of a
     * bush. It bends, but is not drawn. Default: where the foliage needs it.
     */
    complete?: boolean | null;
    /**
     * Accept what the import found without asking: what is left out, uncertain pieces, the up axis, the size.
     */
    accept?: boolean | null;
    /** Name of the tree; default: that of the file. */
    name?: string | null;
  };
  /** A page of the trees: built-in trees first, then by age. */
  TreeList: {
    total: number;
    next: string | null;
    damaged: string[];
    trees: Schemas["TreeSummary"][];
  };
  /** A tree with its report: that of its mesh import and, once it is built, of its build. */
  TreeOut: {
    id: string;
    name: string;
    species: string | null;
    builtin: boolean;
    form?: "open" | "forest";
    grown?: boolean;
    state: "uploaded" | "building" | "preliminary" | "ready" | "failed";
    height_m: number | null;
    table_sha256: string | null;
    bare_table_sha256?: string | null;
    records_sha256: string | null;
    compliance_sha256?: string | null;
    mesh_sha256: string | null;
    job_id: string | null;
    created_at: string;
    updated_at: string;
    report: Record<string, unknown>;
    evergreen: boolean;
  };
  /**
   * Bending strain at the outermost fibre along the axes of a tree, as it is drawn, and what this is not
   * (`caution`).
   */
  TreeStrainOut: {
    points_m: [number, number, number][];
    /** The point that each grows from; −1: the root. */
    parent: number[];
    /** Between a point and its parent; null: not computed. */
    strain: (number | null)[];
    /** Of sound green wood of its species. */
    rupture_strain: number;
    wind_m_s: number;
    direction_deg: number;
    breast_height_strain: number | null;
    largest: Schemas["LargestOut"];
    base_moment_nm: number;
    top_displacement_m: number;
    load_factor: number;
    weight_share: number;
    caution: string;
  };
  /**
   * A tree without its report: `state` is `ready` once it has a complete table; `job_id` is its newest build
   * job. `records_sha256` is null until the records of the paper's state search are computed.
   * `bare_table_sha256` is the table of the same mesh without its leaves, for the winter; null: there is
   * none. `form`: grown in the open, or slender between other trees; a built-in species may have one tree of
   * each form. `compliance_sha256` is needed only to pull the tree at a point. `evergreen`: its species keeps
   * its leaves or needles in winter. `grown`: an individual of a species (POST /api/individuals).
   * `updated_at` changes with every change of the tree, also of its report.
   */
  TreeSummary: {
    id: string;
    name: string;
    species: string | null;
    builtin: boolean;
    form?: "open" | "forest";
    grown?: boolean;
    state: "uploaded" | "building" | "preliminary" | "ready" | "failed";
    height_m: number | null;
    table_sha256: string | null;
    bare_table_sha256?: string | null;
    records_sha256: string | null;
    compliance_sha256?: string | null;
    mesh_sha256: string | null;
    job_id: string | null;
    created_at: string;
    updated_at: string;
    evergreen: boolean;
  };
  /** A valid wind document (spec/formats/wind.md). */
  WindOut: {
    wind: Record<string, unknown>;
  };
  /**
   * Green wood, transversely isotropic about its fibre. Omitted fields are taken from `based_on`. Ratios are
   * relative to the longitudinal modulus; Poisson's ratios are ν_LT and ν_TT; all numbers are finite.
   */
  WoodDocument: {
    /** Display name. */
    name: string;
    /** Species that provides the omitted fields. */
    based_on?: string;
    /** E along the fibre, Pa. */
    young_longitudinal_pa?: number | null;
    /** E_R / E_L. */
    radial_ratio?: number | null;
    /** E_T / E_L. */
    tangential_ratio?: number | null;
    /** G_LR / E_L. */
    shear_lr_ratio?: number | null;
    /** G_LT / E_L. */
    shear_lt_ratio?: number | null;
    /** ν_LT. */
    poisson_longitudinal?: number | null;
    /** ν_TT. */
    poisson_transverse?: number | null;
    /** Density of green wood, kg/m³. */
    density_kg_m3?: number | null;
    /** Bending strength of green wood, Pa. */
    modulus_of_rupture_pa?: number | null;
    /** Damping ratio of the wood. */
    damping_ratio?: number | null;
    /** Relative to the frontal area of the tree. */
    drag_coefficient?: number | null;
    /** Power of the wind speed with which the load grows above 5 m/s, in leaf. */
    streamlined_exponent?: number | null;
    /** Source of the data. */
    source?: string;
  };
  /** All wood species. */
  WoodSpeciesList: {
    species: Schemas["WoodSpeciesOut"][];
  };
  /** A wood species: Young's modulus along the fibre, density, damping, drag and streamlining in leaf. */
  WoodSpeciesOut: {
    id: string;
    name: string;
    young_longitudinal_pa: number;
    density_kg_m3: number;
    damping_ratio: number;
    drag_coefficient: number;
    streamlined_exponent: number;
    source: string;
  };
  /**
   * Problem details (RFC 9457): `code` is machine-readable; `title`, `detail` and `hint` are for users. There
   * is a `detail` only where it says more than `title` and `hint`.
   */
  ProblemOut: {
    type: string;
    title: string;
    status: number;
    detail?: string | null;
    hint: string;
    code: string;
  };
}

/** Smallest and largest values of the import options that are numbers. */
export const IMPORT_LIMITS = {
  height_m: { min: 0.2, max: 120 },
  tree: { min: 1, max: 10000 },
  dbh_cm: { min: 0.5, max: 1500 },
  min_radius_mm: { min: 0, max: 500 },
} as const;
