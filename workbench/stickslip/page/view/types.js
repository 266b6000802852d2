/**
 * The words of the page: they are known in every module but those of the model.
 *
 * @typedef {object} Solution a setting solved: all that the page shows of it
 * @property {Motion} motion
 * @property {Simplified} simple the cycle as designers write it
 * @property {number} v_c critical velocity [m/s], NaN under a friction curve that is not flat
 * @property {number} v_c_simple the same to first order [m/s]
 * @property {Solution} constant the same with constant friction
 *
 * @typedef {object} Page what a section asks of the page
 * @property {(values: Partial<Setting>, look?: Look) => void} set take these values [SI], the
 *   others stay; throws a RangeError with the reason if they are refused
 * @property {() => Setting} setting the values in use
 * @property {(values: Partial<Setting>, curve?: Curve | null) => boolean} isUsed whether these
 *   values [SI] are asked for, with constant friction unless a curve is given
 * @property {() => Solution} solution the setting solved
 * @property {() => string} link an address of the page with the setting in use
 *
 * @typedef {object} Look how a new setting is looked at
 * @property {Partial<Setting>} [over] values [SI] of the setting whose curves stay as a ghost; what
 *   they leave out is as it is
 * @property {"cycles" | "start"} [from] steady cycles, or the first load-up too
 * @property {Curve | null} [curve] the friction curve, null for constant friction; without it the
 *   one in use stays
 * @property {boolean} [still] whether the picture keeps its span
 *
 * @typedef {{from: number, to: number}} Seen a stretch of time [s]
 * @typedef {ReturnType<typeof import("../stage/stretch.js").makeStretch>} Stretch
 *
 * @typedef {Omit<Phase, "n"> & {points: State[]}} SeenPhase a phase as it is drawn: cut to what is
 *   seen [s], with exact states in it
 *
 * @typedef {{size: number, unit: string}} Scale a unit and its size [SI]
 *
 * @typedef {object} Axis
 * @property {number} low lower end [SI]
 * @property {number} high upper end [SI]
 * @property {number} size of its unit [SI]
 * @property {string} title quantity and unit
 * @property {boolean} [log] whether each decade is as long as another
 *
 * @typedef {ReturnType<typeof import("./frame.js").makeFrame>} Frame
 * @typedef {ReturnType<typeof import("../stage/timecharts.js").makeChart>} Chart
 * @typedef {ReturnType<typeof import("./spelled.js").makeReader>} Reader
 * @typedef {ReturnType<typeof import("../stage/schematic.js").layoutOf>} Layout of the schematic
 *
 * @typedef {Setting & {id: string, cures: (Partial<Setting> | null)[]}} Application
 * @typedef {any} Control a row of the page's controls, as controls.toml explains it
 * @typedef {any} Sentence what a sentence asks of the stage, as said.toml explains it
 * @typedef {any} Step of the story, as story.toml explains it
 *
 * @typedef {{words: string, value?: number, far?: boolean}} Offer of a cure: a value of its parameter
 *   [SI], without one the words say why there is none; far: whether it is out of reach
 */
