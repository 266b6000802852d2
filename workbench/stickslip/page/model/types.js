/**
 * The words of the model, SI: they are known in every module.
 *
 * @typedef {object} Setting what is set
 * @property {number} m mass [kg]
 * @property {number} g gravity [m/s^2]
 * @property {number} load normal force on top of the weight m g [N], at least -m g
 * @property {number} k stiffness of the spring [N/m]
 * @property {number} c viscous damping [N s/m]
 * @property {number} mu_s static coefficient [1]
 * @property {number} mu_k kinetic coefficient in use [1], at most mu_s
 * @property {number} v speed of the pulled end [m/s], above 0
 *
 * @typedef {object} Numbers what follows from a setting alone: docs/theory.md (2)
 * @property {number} N normal force [N]
 * @property {number} F_s break-away force [N]
 * @property {number} F_k kinetic friction force [N]
 * @property {number} Delta spring extension from kinetic to static friction [m]
 * @property {number} w natural frequency [rad/s]
 * @property {number} zeta damping ratio [1]
 * @property {number} lambda_ w Delta/v [1]
 *
 * @typedef {object} Period
 * @property {number} t_stick time in stick [s]
 * @property {number} t_slip time in slip [s]
 * @property {number} T period [s]
 * @property {number} f frequency [Hz]
 * @property {number} share share of stick in the period [1]
 *
 * @typedef {object} OfCycle what depends on the slip; NaN where there is no cycle
 * @property {boolean} exists whether a slip from rest comes to rest
 * @property {number} spring_drop relief of the spring in a slip [m]
 * @property {number} delta_x jump of the mass [m]
 * @property {number} x_dot_peak largest velocity of the mass [m/s]
 *
 * @typedef {Numbers & Period & OfCycle} Cycle the exact steady cycle
 * @typedef {Period & {F_s: number, delta_x: number}} Simplified the cycle as designers write it
 *
 * @typedef {object} Bristles LuGre's own numbers
 * @property {number} sigma_0 stiffness of the bristles [N/m]
 * @property {number} sigma_1 their damping [N s/m]
 * @property {number} v_s speed of the fall of friction [m/s]
 *
 * @typedef {{t: number, z: number, x_dot: number, friction: number}} LugreState time [s], extension of
 *   the spring [m], velocity [m/s], friction on the mass with damping [N]
 *
 * @typedef {object} LugreCycle what a block on bristles comes to from rest: "cycle"; "even", it slides
 *   evenly; "creep", so near to that that no growth is followed; "unsettled", nothing
 *   within the bound on work; "none", there is no friction. All but `calm` with a cycle alone
 * @property {"cycle" | "even" | "creep" | "unsettled" | "none"} outcome
 * @property {boolean} calm whether even sliding is stable
 * @property {number} [T] period [s]
 * @property {number} [delta_x] way of the mass in the largest fall of the spring [m]
 * @property {number} [x_dot_peak] largest velocity [m/s]
 * @property {number} [friction_max] largest friction, damping included [N]
 * @property {number} [F_max] largest spring force [N]
 * @property {number} [falls] falls of the spring in the cycle
 * @property {LugreState[]} [states] along it, from the maximum of the spring
 *
 * @typedef {[u: number, mu: number][]} Curve a friction curve: speeds [m/s], rising from 0, and
 *   coefficients in slip; straight lines between the points, constant beyond the last
 *
 * @typedef {object} Band speeds on one line of a curve: slip is linear there
 * @property {number} low lower end [m/s]
 * @property {number} high upper end [m/s], infinite for the last
 * @property {number} fall -dmu/du [s/m]
 * @property {Oscillator} oscillator damped by the line's slope too
 *
 * @typedef {object} Oscillator m y'' + c y' + k y = 0
 * @property {number} w natural frequency [rad/s]
 * @property {number} a rate of decay zeta w [1/s]; below 0 where it grows
 * @property {number} b sqrt(|w^2 - a^2|) [rad/s]
 * @property {number} fast the faster rate of decay [1/s]; a, if it is not overdamped
 * @property {number} slow the slower rate of decay [1/s]; a, if it is not overdamped
 * @property {boolean} overdamped whether zeta is 1 or more
 *
 * @typedef {object} SlipState the state of a slip at a time after its break-away
 * @property {number} displacement of the mass [m]
 * @property {number} x_dot velocity of the mass [m/s]
 * @property {number} x_ddot acceleration of the mass [m/s^2]
 * @property {number} growth of the spring's extension [m]
 * @property {number} [mode] direction of slip, forward if none is given: 1, or -1 backward
 *
 * @typedef {object} Slip the slip from rest, followed without end
 * @property {(tau: number) => SlipState} at the state, tau [s] after the break-away
 * @property {{tau: number, growth: number} | null} overshoot when [s] the spring is longest and
 *   how much it has grown by then [m]; null where it has no maximum
 * @property {number} rate of its fastest change [rad/s]
 * @property {number} slow its slower rate of decay [1/s], at the speed of the pull
 * @property {number} scale duration of a swing, or three times that of the slower decay [s]
 * @property {(from: number, to: number) => Iterable<Piece>} pieces its arcs that touch a stretch of
 *   time since break-away [s]
 * @property {() => boolean} settles whether a slip without end ends in steady sliding
 *
 * @typedef {Oscillator & {start: number, end: number, rate: number, turns: boolean}} Piece of a slip
 *   on one line of the friction curve: times since break-away [s], the rate of its fastest change
 *   [rad/s], and whether the direction of slip changes at its end
 *
 * @typedef {{band: Band, index: number, mode: number, start: number, end: number}} OfArc
 * @typedef {SlipState & OfArc} Arc a slip on one line of a curve, with its state at the start, the
 *   direction 1 forward or -1 backward, and times since break-away [s]: no end on that line is
 *   infinite
 *
 * @typedef {object} Course how an arc goes on
 * @property {number} tau when its speed leaves the line [s], infinite for never
 * @property {boolean} rising whether it leaves it upwards
 * @property {number} highest velocity where it first turned, if that was from rising [m/s], or NaN
 * @property {number} highestAt when [s]
 * @property {number} lowest velocity where it first turned from falling to rising [m/s], or NaN
 *
 * @typedef {Setting & Numbers & {bands: Band[], first: number}} Contact what the slips of a setting
 *   share, whatever the speed of the pull: bands of the friction curve and the acceleration just after
 *   a break-away [m/s^2]; its F_k is friction at the beginning of slip
 *
 * @typedef {object} Chain a slip from break-away, up to where its end is decided
 * @property {Arc[]} arcs
 * @property {boolean} rests whether it comes to rest
 * @property {number} t_slip time until it rests [s], NaN if never
 * @property {number} spring_drop relief of the spring until then [m]
 * @property {number} peak velocity at its first maximum [m/s]; NaN if it has none
 * @property {number} peakAt when [s]
 * @property {number} margin above 0 where it never rests, below where it does [1]: the least speed
 *   of the slip over that of the pull, or how far the spring at the end of a slip back is above
 *   F_s, over F_s
 *
 * @typedef {{low: number, high: number, sticks: boolean, even: boolean}} Regime speeds of the pull
 *   [m/s] with one answer: whether the slip from break-away comes to rest, and whether steady sliding
 *   is stable; neither: it swings
 *
 * @typedef {object} State the motion at a time
 * @property {number} t time [s]
 * @property {number} mode 0: stick, 1: slip, -1: slip backward
 * @property {number} x position of the mass [m]
 * @property {number} x_dot its velocity [m/s]
 * @property {number} x_ddot its acceleration [m/s^2]
 * @property {number} x_pull position of the pulled end [m]
 * @property {number} z extension of the spring [m]
 * @property {number} F spring force [N]
 * @property {number} F_dot its rate [N/s]
 * @property {number} F_friction force of the way on the mass, damping included [N]
 *
 * @typedef {{kind: "stick" | "slip", n: number, start: number, end: number}} Phase a stick or a slip
 *   after n slips, times [s]; a slip without end has an infinite one
 *
 * @typedef {[high: number, low: number]} Twofold a number with twice the digits: their sum
 *
 * @typedef {{t: number, kind: "break-away" | "re-stick"}} Transition at a time [s]
 *
 * @typedef {object} Motion the whole motion of a setting
 * @property {Setting} p
 * @property {Curve | null} curve the friction curve, null for constant friction
 * @property {Numbers} numbers what follows from the setting alone; under a curve its mu_k is mu_1
 * @property {Cycle} cycle the steady cycle
 * @property {Slip} slip the slip of every cycle, or the one without end
 * @property {number} first when the mass first breaks away [s]
 * @property {number} beat period, or the scale of a slip without end [s]
 * @property {number} z_s extension of the spring at break-away [m]
 * @property {number} z_even the same in steady sliding [m]
 * @property {(t: number) => State} at the state at a time [s], from 0 on
 * @property {(t: number, n: number, left: number) => State} sticking the state at a time [s] in
 *   the stick after n slips, `left` [s] before it breaks away
 * @property {(t: number, n: number, tau: number) => State} slipping the state at a time [s] in
 *   the slip after n others, `tau` [s] after its break-away
 * @property {(from: number, to: number) => Iterable<Phase>} phases those that touch a stretch [s]
 * @property {(from: number, to: number) => Iterable<Transition>} events those in a stretch [s]
 *
 * @typedef {{cosines: number[], sines: number[]}} Harmonics of a velocity [m/s]: the sum of
 *   cosines[n] cos(n W t) + sines[n] sin(n W t), W = 2 pi/T; the first cosine is the mean
 *
 * @typedef {"stiffer" | "softer" | "damping" | "slower" | "faster" | "gap" | "normal force" | "lighter"} CureName
 * @typedef {"k" | "c" | "v" | "mu_k" | "load" | "m"} Lever
 *
 * @typedef {object} Cure one parameter changed in one direction, all others held
 * @property {CureName} name
 * @property {Lever} parameter what it changes: the gap by mu_k, the normal force by the load; the
 *   mass with the load held
 * @property {number} now the value in use [SI]
 * @property {number | null} halve the value at which the jump is half of what it is [SI]
 * @property {number | null} end the limit of the cycle: beyond it there is none [SI]
 * @property {number} least the smallest jump on this way over the jump now [1]; 1 where it grows
 *
 * @typedef {object} Cures what suppresses the cycle of a setting
 * @property {number} jump of the mass now [m], NaN without a cycle
 * @property {number} v_c critical velocity [m/s]
 * @property {Cure[]} cures none where there is no cycle
 *
 * @typedef {(log: number) => Setting} Way a path through the settings, by the logarithm of what
 *   changes
 */
