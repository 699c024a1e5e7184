/** Constants that Python and TypeScript share, written from spec/constants.json by `make constants`. */

// ---- pressure of the wind ---------------------------------------------------------------------------------

/** Dynamic pressure over speed squared up to the streamlining speed; the air has 1.2 kg/m³ [Pa·s²/m²]. */
export const HALF_AIR_DENSITY_KG_M3 = 0.6;
/**
 * Above this speed the pressure grows with the streamlined exponent of the tree (metadata of the table)
 * [m/s].
 */
export const STREAMLINING_SPEED_M_S = 5;
/** Dynamic pressure at the streamlining speed [Pa]. */
export const STREAMLINING_PRESSURE_PA = 15;
/** Pressures beyond the sampled range are compressed: 2 times the range to 1.40, 5 times to 1.71. */
export const PRESSURE_COMPRESSION = 0.25;

// ---- wind document ----------------------------------------------------------------------------------------

/** Version of the wind document. */
export const WIND_VERSION = 1;
/** Models of the gusts. */
export const WIND_MODELS = ["cosine", "perlin", "spectral", "navier-stokes", "recorded"] as const;
/** Models that depend on the time rather than on the distance travelled. */
export const TIMED_MODELS = ["cosine", "recorded"] as const;
/**
 * Numbers of a wind document: range, the models that have the field (without it: all), and the default
 * (without it: required).
 */
export const WIND_FIELDS = {
  mean_speed_m_s: { low: 0, high: 60 },
  direction_deg: { low: -360, high: 360 },
  gustiness: { low: 0, high: 1 },
  convection_speed_m_s: { low: 0.5, high: 60 },
  seed: { low: 0, high: 4294967295, whole: true },
  length_scale_m: { low: 5, high: 200, models: ["perlin", "spectral", "navier-stokes"] },
  beta: { low: 0, high: 2, models: ["spectral"], default: 1.6666666666666667 },
  height_exponent: { low: 0, high: 1, default: 0.2 },
  reference_height_m: { low: 1, high: 60, default: 12 },
  heading_swing_deg: { low: 0, high: 60, models: ["cosine"], default: 12 },
} as const;
/** Fields of a wind document that are not numbers, by model. */
export const WIND_LISTS = {
  cosine: ["waves"],
  recorded: ["recording"],
} as const;
/** Length scale wherever one is needed for a model that has none [m]. */
export const UNUSED_LENGTH_SCALE_M = 20;
/** Most waves of a cosine document. */
export const MOST_WAVES = 16;
/** Numbers of a wave; a negative phase derives it from the seed. */
export const WAVE_FIELDS = {
  frequency_hz: { low: 0.001, high: 4 },
  share: { low: 0, high: 1 },
  across: { low: -2, high: 2, default: 0 },
  phase_turns: { low: 0, high: 1, default: -1 },
} as const;
/** By how much the sum of the shares may exceed 1. */
export const WAVE_SHARE_TOLERANCE = 1e-9;
/**
 * Waves of a cosine document without its own. The amplitudes decrease roughly as f^(−1/3), as a −5/3 power
 * spectrum requires, and sum to one. `across` is the wavenumber across the wind relative to that along it;
 * alternating signs make the gusts cross.
 */
export const FOREST_WAVES = [
  { frequency_hz: 0.05, share: 0.262, across: 0.6 },
  { frequency_hz: 0.087, share: 0.218, across: -0.45 },
  { frequency_hz: 0.152, share: 0.181, across: 0.75 },
  { frequency_hz: 0.264, share: 0.15, across: -0.6 },
  { frequency_hz: 0.46, share: 0.105, across: 0.5 },
  { frequency_hz: 0.8, share: 0.084, across: -0.7 },
] as const;
/** Numbers of a recording: interval of its samples, and the fluctuation that one count stands for. */
export const RECORDING_FIELDS = {
  interval_s: { low: 0.05, high: 3600 },
  unit: { low: 0, high: 1000 },
} as const;
/** Fewest samples of a recording. */
export const FEWEST_RECORDING_SAMPLES = 2;
/** Ten minutes at 10 Hz: 32 kB of text, so that a state with three documents stays below 100 kB. */
export const MOST_RECORDING_SAMPLES = 6000;
/** The recording of a wind without fluctuations. */
export const STILL_RECORDING = { interval_s: 1, unit: 0, pairs: "AAAAAAAAAAA=" } as const;
/** Named winds of the forest page. */
export const WIND_PRESETS = {
  still: {
    version: 1,
    model: "spectral",
    direction_deg: 30,
    seed: 1,
    mean_speed_m_s: 0,
    gustiness: 0.6,
    convection_speed_m_s: 2,
    length_scale_m: 28,
  },
  breeze: {
    version: 1,
    model: "perlin",
    direction_deg: 30,
    seed: 1,
    mean_speed_m_s: 4,
    gustiness: 0.4,
    convection_speed_m_s: 4,
    length_scale_m: 18,
  },
  "autumn-gusts": {
    version: 1,
    model: "spectral",
    direction_deg: 30,
    seed: 1,
    mean_speed_m_s: 9,
    gustiness: 0.75,
    convection_speed_m_s: 10,
    length_scale_m: 28,
  },
  "storm-front": {
    version: 1,
    model: "navier-stokes",
    direction_deg: 30,
    seed: 1,
    mean_speed_m_s: 20,
    gustiness: 0.9,
    convection_speed_m_s: 16,
    length_scale_m: 34,
  },
} as const;
/**
 * Peak speed over design speed, depth (U = peak (1 + depth cos) / (1 + depth)), period in s and phase in
 * turns of the paper's six cosine winds. The paper shows them only in a figure without numbers; these span
 * the same range.
 */
export const PAPER_WAVES = [
  [0.3, 0.5, 4, 0.5],
  [0.45, 0.9, 3, 0.5],
  [0.6, 0.3, 6, 0.6],
  [0.75, 0.7, 2.5, 0.45],
  [0.9, 0.3, 5, 0.55],
  [1, 0.8, 3.5, 0.5],
] as const;

// ---- state of a wind --------------------------------------------------------------------------------------

/** Time in which a change of the wind is interpolated from the old document to the new one [s]. */
export const TRANSITION_S = 0.6;
/** Most gust fronts at once; a further one replaces the oldest. */
export const MOST_FRONTS = 4;
/** A front is forgotten after this time [s]. */
export const FRONT_LIFE_S = 30;
/** Half the extent of a front along the wind [m]. */
export const FRONT_DEPTH_M = 14;
/** Half the width of a front at the start [m]. */
export const FRONT_WIDTH_M = 16;
/** By how much that grows per metre travelled [m/m]. */
export const FRONT_SPREAD = 0.35;
/** Distance after which a front has died down [m]. */
export const FRONT_RANGE_M = 180;
/** Time in which a front reaches its strength [s]. */
export const FRONT_RISE_S = 0.6;
/** Speed that a front adds in still air [m/s]. */
export const FRONT_LEAST_GUST_M_S = 6;
/** Further speed that it adds, over the mean speed. */
export const FRONT_GUST_SHARE = 0.8;
/** Least speed at which a front travels [m/s]. */
export const FRONT_LEAST_TRAVEL_M_S = 9;
/** Speed at which it travels over the mean speed. */
export const FRONT_TRAVEL_SHARE = 1.2;
/** Numbers of a front and their ranges. */
export const FRONT_LIMITS = {
  since_s: [-1e9, 1e9],
  x_m: [-1e6, 1e6],
  z_m: [-1e6, 1e6],
  direction_deg: [-360, 360],
  mean_speed_m_s: [0, 60],
} as const;

// ---- hashes of the wind -----------------------------------------------------------------------------------

/** 0x9E3779B9, 2³² over the golden ratio: spreads the index of a hash. */
export const HASH_GOLDEN = 2654435769;
/** 0x45D9F3B, the factor of Mueller's integer finaliser. */
export const HASH_FACTOR = 73244475;
/** 2π / 2³²: a hash times this is an angle [rad]. */
export const HASH_TURN_RAD = 1.4629180792671596e-9;

// ---- gusts of a forest ------------------------------------------------------------------------------------

/** Standard deviation of the speed over its mean at gustiness 1, as produced by the cosine model. */
export const TURBULENCE_PER_GUSTINESS = 0.308;
/** Frequency with which the heading oscillates [Hz]. */
export const COSINE_HEADING_HZ = 0.03;
/** Index of the phase used for this oscillation. */
export const COSINE_HEADING_PHASE = 6;
/** Gradient directions: from the centre of a cube to its twelve edges, four of them twice. */
export const PERLIN_EDGES = [
  [1, 1, 0],
  [-1, 1, 0],
  [1, -1, 0],
  [-1, -1, 0],
  [1, 0, 1],
  [-1, 0, 1],
  [1, 0, -1],
  [-1, 0, -1],
  [0, 1, 1],
  [0, -1, 1],
  [0, 1, -1],
  [0, -1, -1],
  [1, 1, 0],
  [0, -1, 1],
  [-1, 1, 0],
  [0, -1, -1],
] as const;
/**
 * 35054270/480729249 = 16 A² B with A = ∫(1−f)², B = ∫(1−f)² t², f the fade 6t⁵ − 15t⁴ + 10t³, over [0, 1].
 */
export const PERLIN_NOISE_VARIANCE = 0.07291894569119509;
/** Fluctuation across the wind over that along it. */
export const PERLIN_LATERAL_SHARE = 0.5;
/** A lattice cell of the first octave spans two length scales. */
export const PERLIN_CELLS_PER_SCALE = 0.5;
/** Amplitude of an octave over that of the octave before it. */
export const PERLIN_GAIN = 0.6;
/** Octaves along the wind; there is one across it. */
export const PERLIN_OCTAVES = 3;
/** Lateral drift: the noise is zero at its lattice points, and no tree should stay on a lattice line. */
export const PERLIN_SLANT = 0.17;
/** Evolution of the noise, in lattice cells per length scale travelled. */
export const PERLIN_CHANGE = 0.1;
/** Grid cells of the field along the wind: 64 length scales. */
export const SPECTRAL_COLUMNS = 1024;
/** Grid cells of the field across the wind: 32 length scales. */
export const SPECTRAL_ROWS = 128;
/** Grid cells per length scale along the wind. */
export const SPECTRAL_CELLS_ALONG = 16;
/** Grid cells per length scale across the wind. */
export const SPECTRAL_CELLS_ACROSS = 4;
/** Fluctuation across the wind over that along it. */
export const SPECTRAL_LATERAL_SHARE = 0.5;
/**
 * Lateral drift: about 0.382 field widths per field length, which spreads successive passes over a tree
 * evenly.
 */
export const SPECTRAL_SLANT = 0.0955;
/** Factor of n² in von Kármán's spectrum (ESDU 85020). */
export const SPECTRAL_VON_KARMAN = 70.8;
/** Davenport's decay constant across the wind. */
export const SPECTRAL_DECAY = 7;
/** The width of the slowest gusts is limited to that of this reduced frequency n. */
export const SPECTRAL_SLOWEST_COHERENCE = 0.15;
/** Cells per side of the grid of the eddies: 25.6 length scales. */
export const EDDY_GRID = 128;
/** Grid cells per length scale. */
export const EDDY_CELLS_PER_SCALE = 5;
/** Distance in cells that air at one standard deviation moves per step. */
export const EDDY_CELLS_PER_STEP = 0.5;
/**
 * Solver steps per length scale travelled by the air; air at one standard deviation moves a tenth of a scale
 * per step. Gusts thus stay coherent while they cross the forest. At six times this rate, the time of best
 * correlation between two places is 5 % early.
 */
export const EDDY_STEPS_PER_SCALE = 0.5;
/** Wavenumbers that are forced: at least the first and below the second number of waves across the grid. */
export const EDDY_BAND = [4, 7] as const;
/** Forcing per step, approximately relative to the amplitude. */
export const EDDY_KICK = 0.06;
/** Friction per step. */
export const EDDY_FRICTION = 0.01;
/** Friction F / k² that opposes the inverse cascade, which would otherwise end in one pair of eddies. */
export const EDDY_LARGE_SCALE_FRICTION = 0.5;
/** Smallest wavenumber of the field that a run starts from. */
export const EDDY_SLOWEST_START = 3;
/** Steps after which the next run of the solver starts. */
export const EDDY_EPOCH = 128;
/** Steps in which consecutive runs are cross-faded. */
export const EDDY_OVERLAP = 32;
/** Equal along and across the wind, as in any isotropic divergence-free field. */
export const EDDY_LATERAL_SHARE = 1;
/** A recording holds both components in the same unit. */
export const RECORDED_LATERAL_SHARE = 1;

// ---- gusts within a crown ---------------------------------------------------------------------------------

/** Cells per side of the field, which repeats after 48 m. */
export const CROWN_CELLS = 64;
/** Side of a cell [m]. */
export const CROWN_CELL_M = 0.75;
/** Periods of the longest waves, of 12 m, per field width. */
export const CROWN_FEWEST_PERIODS = 4;
/** Periods of the shortest waves, of 3 m, per field width. */
export const CROWN_MOST_PERIODS = 16;
/** Plane waves of the field. */
export const CROWN_WAVES = 48;
/**
 * Standard deviation of each component over the mean speed, for a gustiness of 1. Assumed. Near the top of a
 * canopy the turbulence intensity is about 0.5, and larger below (Raupach, Finnigan & Brunet 1996;
 * unchecked); the gust models provide 0.3 at this gustiness.
 */
export const CROWN_INTENSITY = 0.6;
/** Shift of the field along the wind per metre of height: gusts reach the top first [m/m]. */
export const CROWN_LEAN_ALONG = -0.6;
/** Shift of the field across the wind per metre of height [m/m]. */
export const CROWN_LEAN_ACROSS = 0.8;
/** Lateral drift, so that the periodic field does not return to the same tree. */
export const CROWN_SLANT = 0.191;
/** Limit of the relative speed of a gust, which keeps the wind from turning back. */
export const CROWN_MOST_GUST = 0.9;

// ---- table file -------------------------------------------------------------------------------------------

/** Field `format` of a table's metadata. */
export const TABLE_FORMAT = "galewood-table";
/** Version of the table file. */
export const TABLE_VERSION = 1;
/** Longest header of a table, records or compliance file [bytes]. */
export const MAX_TABLE_HEADER_BYTES = 1048576;
/** Most modes of a table. */
export const MAX_MODES = 256;
/** Most oscillators of the modal model. */
export const MAX_OSCILLATORS = 64;
/** Most drag points of the modal model. */
export const MAX_DRAG_POINTS = 32;
/** Most places of the crown whose gusts drive the modal model. */
export const MAX_PLACES = 32;
/** Numbers of a table's metadata and their ranges. */
export const TABLE_RANGES = {
  height_m: [0.01, 1000],
  dt_s: [0.0001, 1],
  design_speed_m_s: [0, 100],
  streamlined_exponent: [1, 2],
  peak_pressure_pa: [0, 1e9],
  reach_m: [0, 10000],
} as const;
/** Type and rank of the tensors of a table. */
export const TABLE_TENSORS = {
  "modes.scale": ["F32", 1],
  "nodes.basis": ["F32", 3],
  "nodes.rest_m": ["F32", 2],
  "nodes.turn": ["F32", 3],
  "nodes.parent": ["U16", 1],
  "joints.nodes": ["U16", 2],
  "joints.share": ["F32", 1],
  "joints.rest_m": ["F32", 2],
  "render.vertex_joint": ["U16", 1],
  "modal.step": ["F32", 2],
  "modal.load": ["F32", 2],
  "modal.sway": ["F32", 2],
  "modal.force": ["F32", 2],
  "modal.shown": ["F32", 1],
  "modal.pose": ["F32", 2],
  "modal.limits": ["F32", 1],
  "modal.drag_point": ["F32", 2],
  "modal.drag_shape": ["F32", 3],
  "modal.drag_rest": ["F32", 1],
  "modal.drag_place": ["F32", 2],
  "modal.place": ["F32", 2],
  "modal.place_load": ["F32", 3],
} as const;
/** Field `format` of a records file's metadata. */
export const RECORDS_FORMAT = "galewood-records";
/** Version of the records file. */
export const RECORDS_VERSION = 1;
/** Type and rank of the tensors of the paper's records, in a table or in a file of their own. */
export const RECORD_TENSORS = {
  "samples.dq": ["I16", 2],
  "samples.pressure_pa": ["F32", 2],
  "samples.trajectory": ["U32", 1],
  "search.offsets": ["U32", 1],
  "search.record": ["U16", 1],
  "search.mismatch_steps": ["U16", 1],
} as const;

// ---- compliance file --------------------------------------------------------------------------------------

/** Field `format` of a compliance file's metadata. */
export const COMPLIANCE_FORMAT = "galewood-compliance";
/** Version of the compliance file. */
export const COMPLIANCE_VERSION = 1;
/** Most free nodes of the solid. */
export const MAX_COMPLIANCE_NODES = 65534;
/** Points of the solid that a vertex of the render mesh follows. */
export const BINDING_CORNERS = 4;
/** Sum of the weights of a row of the binding. */
export const WHOLE_WEIGHT = 65535;
/** Type and rank of the tensors of a compliance file. */
export const COMPLIANCE_TENSORS = {
  "factor.pointer": ["U32", 1],
  "factor.rows": ["U16", 1],
  "factor.blocks": ["F32", 2],
  "nodes.mass_kg": ["F32", 1],
  "nodes.limit_n": ["F32", 1],
  "bind.node": ["U16", 2],
  "bind.weight": ["U16", 2],
  "bind.vertex_row": ["U32", 1],
} as const;

// ---- modal model ------------------------------------------------------------------------------------------

/** Most steps of one call: after a long pause a tree resumes instead of catching up. */
export const MAX_STEPS_PER_ADVANCE = 8;
/**
 * The arguments of the polynomials are clamped to this multiple of the sampled range. The force stays
 * bounded, and as the linear step contracts, any bounded wind gives a bounded motion.
 */
export const MODAL_REACH = 1.25;
/** Most sums that take the place of the terms of a force, if these drive the oscillators in so few ways. */
export const MOST_TERM_SUMS = 4;
/** What the sums leave of a term's numbers, over the largest of them, when it is their rounding. */
export const TERM_SUM_ROUNDING = 2.384185791015625e-7;
/** In still air a motion below this share of the sampled range is set to exactly zero. */
export const MODAL_REST = 1e-7;
/** Fewest oscillators whose speed determines the velocity of the drag points; otherwise half of them. */
export const FEWEST_DRAG_INPUTS = 8;
/** 4/3: mean over all directions of the derivative of a quadratic drag, over pressure per speed. */
export const ISOTROPIC_DRAG = 1.3333333333333333;

// ---- drawn vertices ---------------------------------------------------------------------------------------

/** Length of a link between nodes, relative to rest, from which it is shortened. */
export const LONGEST_LINK = 1.02;
/** Stretch of a link up to which it is taken off the rotation: that of a linear motion at an angle of 60°. */
export const MOST_LINK_STRETCH = 2;
/** Arm at which rotation counts as displacement where nodes are chosen or merged, relative to the height. */
export const TURN_ARM = 0.02;

// ---- inventory document -----------------------------------------------------------------------------------

/** Version of the inventory document. */
export const INVENTORY_VERSION = 1;

// ---- state search -----------------------------------------------------------------------------------------

/** Search the records of moving air (0), of still air (1), or these: all. */
export const SEARCH_ANY_AIR = -1;
/** Pose easing snaps to the record's pose once the offset and its speed are below half an integer step. */
export const SEARCH_SNAP = 0.5;
/** Terms of the Taylor series of exp(−t) for small t. */
export const EXPONENTIAL_TERMS = 12;
/** Its argument is divided by 2 to this power, and the result squared as often. */
export const EXPONENTIAL_SQUARINGS = 8;

// ---- pulling ----------------------------------------------------------------------------------------------

/** Directions in which a point yields less than this share of its mean barely move. */
export const PULL_STRETCH_SHARE = 0.12;
/** Time constant with which the force follows the target [s]. */
export const PULL_LAG_S = 0.05;
/** Largest displacement by pulling, relative to the height. */
export const PULL_MOST_REACH = 0.15;
/** Largest pulling force over the breaking force: up to it a linear response is off by about 2 % at most. */
export const PULL_FORCE_SHARE = 0.4;
/** A pull at this distance from a tree's place means that tree [m]. */
export const PULL_SAME_PLACE_M = 0.05;
/** Time in which a tree of the paper's method, which has no oscillators, returns after a release [s]. */
export const PULL_EASE_S = 0.7;

// ---- wire protocol ----------------------------------------------------------------------------------------

/** Version of the wire protocol. */
export const WIRE_VERSION = 1;
/** First bytes of every message. */
export const WIRE_MAGIC = "GW";
/** What precedes the header: magic, version, kind, length [bytes]. */
export const WIRE_PREFIX_BYTES = 8;
/** Longest header: room for a state with three recorded winds [bytes]. */
export const WIRE_MAX_HEADER_BYTES = 131072;
/** Frames per second of a stream and ticks per second of a forest's clock [Hz]. */
export const TICK_HZ = 30;
/** Kind of message, from a client: its name. */
export const WIRE_HELLO = 1;
/** Kind of message, from a client: requests a forest. */
export const WIRE_FOREST = 2;
/** Kind of message, from a client: changes the wind. */
export const WIRE_WIND = 3;
/** Kind of message, from a client: requests PONG. */
export const WIRE_PING = 4;
/** Kind of message, from a client: stops or resumes the clock. */
export const WIRE_PAUSE = 5;
/** Kind of message, from a client: requests a key frame. */
export const WIRE_RESYNC = 6;
/** Kind of message, from a client: a hand moves a vertex. */
export const WIRE_PULL = 7;
/** Kind of message, from a client: a hand lets go. */
export const WIRE_RELEASE = 8;
/** Kind of message, from a client: starts a gust front. */
export const WIRE_GUST = 9;
/** Kind of message, from the server: the reply to HELLO. */
export const WIRE_WELCOME = 65;
/** Kind of message, from the server: a piece of a table file. */
export const WIRE_TABLE = 66;
/** Kind of message, from the server: poses. */
export const WIRE_FRAME = 67;
/** Kind of message, from the server: why it closes the connection. */
export const WIRE_ERROR = 68;
/** Kind of message, from the server: the reply to PING. */
export const WIRE_PONG = 69;
/** Kind of message, from the server: the state of the wind. */
export const WIRE_WIND_STATE = 70;
/** Kind of message, from the server: the time of the forest. */
export const WIRE_CLOCK = 71;
/** Kind of message, from the server: describes a shared forest. */
export const WIRE_SHARED = 72;
/** Kind of message, from the server: who pulls what. */
export const WIRE_PULLS = 73;
/** Kind of message, from the server: how many clients share the forest. */
export const WIRE_PRESENCE = 74;
/** Optional fields of FOREST. */
export const FOREST_OPTIONS = ["pose_easing", "method", "share", "replant", "about", "have"] as const;
/**
 * Most trees of a forest that a server steps, unless it is set otherwise; larger ones are played by their
 * clients.
 */
export const MOST_STREAMED_TREES = 20000;
/** Most entries in a forest's `about`. */
export const MOST_ABOUT_ENTRIES = 32;
/** Most pulls of one forest. */
export const MOST_PULLS_OF_FOREST = 32;
/** Largest coordinate of a place [m]. */
export const PULL_PLACE_M = 1e6;
/** Largest component of a target, a displacement from rest [m]. */
export const PULL_TARGET_M = 1000;
/** Largest component of a pulling force [N]. */
export const PULL_FORCE_N = 1e9;

// ---- trees ------------------------------------------------------------------------------------------------

/** Height at which the diameter of a trunk is measured [m]. */
export const BREAST_HEIGHT_M = 1.3;

// ---- levels of detail -------------------------------------------------------------------------------------

/** Share of the leaves and twigs that each level of detail shows. */
export const LEVEL_SHARES = [1, 0.5, 0.25, 0.13, 0.07] as const;
/** A piece shrinks while its rank is between the share and (1 + this) times the share. */
export const SHRINK_RANK_WIDTH = 0.2;
/**
 * Remaining leaves grow to keep the area of the crown, up to this factor: larger ones look like no leaves.
 */
export const MOST_LEAF_GROWTH = 2.4;
/**
 * The foot of a branch is its vertex of the least horizontal distance from the trunk plus this times its
 * height.
 */
export const BRANCH_FOOT_WEIGHT = 0.3;
/** Second number of the hash by which leaves are ranked. */
export const RANK_SALT = 11;
