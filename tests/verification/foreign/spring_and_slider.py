"""A slider pulled over dry friction by a spring, undamped, solved exactly between its events.

It shares nothing with the block under test: another writing of the same physics, for the tests.
SI throughout. A slip is worked on in the mirror, so that the slider always moves forward in it.
"""

import math


class SpringAndSlider:
    """Mass [kg], gravity [m/s2], stiffness [N/m], two friction coefficients; pulled at speed [m/s].

    ``position`` and ``speed`` are the slider's [m, m/s], ``driven`` is where the pulled end is [m],
    ``extension`` the spring's [m], ``phase`` -1, 0 or +1; ``pull`` may change between moves.
    """

    def __init__(self) -> None:
        self.mass = 1.0
        self.gravity = 9.81
        self.stiffness = 1000.0
        self.mu_static = 0.5
        self.mu_kinetic = 0.3
        self.pull = 0.02
        self.position = 0.0
        self.speed = 0.0
        self.driven = 0.0
        self.extension = 0.0
        self.phase = 0
        self.jump = 0.0
        self.relief = 0.0
        self.stick_time = 0.0
        self.slip_time = 0.0
        self.period = 0.0
        self.top_speed = 0.0
        self.count = 0
        # What the arc began with, its age, and how long its phase had lasted when it began.
        self.arc: dict[str, float] = {}
        # Time [s] of the slips since the last break-away; negative before the first.
        self.slipped = -1.0
        # Position, extension and greatest speed of the slip that is on.
        self.slip_from = [0.0, 0.0, 0.0]

    @property
    def kinetic(self) -> float:
        """Kinetic coefficient in use: above the static one it makes no sense."""
        if self.mu_kinetic > self.mu_static:
            return max(self.mu_static - 0.01, 0.0)
        return self.mu_kinetic

    @property
    def weight(self) -> float:
        """Normal force [N]."""
        return self.mass * self.gravity

    @property
    def force(self) -> float:
        """Spring force [N]."""
        return self.stiffness * self.extension

    @property
    def friction(self) -> float:
        """Friction force on the slider [N]."""
        if self.phase == 0:
            return -self.force
        return -self.phase * self.kinetic * self.weight

    @property
    def threshold(self) -> float:
        """Break-away force [N]."""
        return self.mu_static * self.weight

    def start(self) -> None:
        """Begin at rest on a relaxed spring."""
        self._new_arc(0.0)

    def move(self, h: float) -> None:
        """Go on by h seconds, over as many events as there are."""
        if self.pull != self.arc["pull"]:
            self._peak(self.arc["age"])
            self._new_arc(self.arc["since"] + self.arc["age"])
        left = h
        while True:
            end = self._end()
            rest = end - self.arc["age"]
            if rest > left:
                self.arc["age"] += left
                self._show(self.arc["age"])
                return
            left -= max(rest, 0.0)
            if self.phase == 0:
                self._break_away(end)
            else:
                self._stop(end)

    def _new_arc(self, since: float) -> None:
        """Begin an arc from what is shown; its phase has lasted `since` seconds."""
        self.arc = {
            "z": self.extension,
            "x": self.position,
            "speed": self.speed,
            "pull": self.pull,
            "age": 0.0,
            "since": since,
        }

    def _slip(self) -> tuple[float, float, float, float, float]:
        """Return w, way from the balance, pull, what decides the stop and phase angle, mirrored."""
        s = self.phase
        w = math.sqrt(self.stiffness / self.mass)
        balance = self.kinetic * self.weight / self.stiffness
        u = s * self.arc["z"] - balance
        v, speed = s * self.arc["pull"], s * self.arc["speed"]
        q = (w * u) ** 2 - speed * (2.0 * v - speed)
        angle = math.atan2(w * u, v - speed) % (2.0 * math.pi)
        return w, u, v, q, angle

    def _end(self) -> float:
        """Age [s] at which the arc ends."""
        if self.phase == 0:
            pull = self.arc["pull"]
            if pull == 0.0:
                return math.inf
            reach = math.copysign(self.threshold / self.stiffness, pull)
            return max((reach - self.arc["z"]) / pull, 0.0)
        w, _, v, q, angle = self._slip()
        if q < 0.0:
            return math.inf
        stop = 2.0 * math.pi - math.atan2(math.sqrt(q), v)
        return max((stop - angle) / w, 0.0)

    def _show(self, age: float) -> None:
        """Set the motion to this age of the arc."""
        arc, pull = self.arc, self.arc["pull"]
        if self.phase == 0:
            self.extension = arc["z"] + pull * age
        else:
            s = self.phase
            w, u, v, _, angle = self._slip()
            radius = math.hypot(w * u, v - s * arc["speed"])
            # The change since the arc began, so that nothing is lost in a short time.
            half = 0.5 * w * age
            change = 2.0 * radius / w * math.sin(half) * math.cos(angle + half)
            self.extension = arc["z"] + s * change
            self.position = arc["x"] + pull * age - s * change
            self.speed = s * (v - radius * math.cos(angle + w * age))
        self.driven = self.position + self.extension

    def _break_away(self, age: float) -> None:
        pull = self.arc["pull"]
        duration = self.arc["since"] + age
        self.extension = math.copysign(self.threshold / self.stiffness, pull)
        self.driven = self.position + self.extension
        self.stick_time = duration
        if self.slipped >= 0.0:
            self.period = self.slipped + duration
        self.slipped = 0.0
        self.phase = 1 if pull > 0.0 else -1
        self.slip_from = [self.position, self.extension, 0.0]
        self._new_arc(0.0)

    def _stop(self, age: float) -> None:
        s = self.phase
        w, u, _, q, _ = self._slip()
        self._peak(age)
        landed = s * (s * self.arc["z"] - u - math.sqrt(max(q, 0.0)) / w)
        self.position = self.arc["x"] + self.arc["pull"] * age - (landed - self.arc["z"])
        self.extension = landed
        self.driven = self.position + landed
        self.speed = 0.0
        self.slip_time = self.arc["since"] + age
        self.jump = self.position - self.slip_from[0]
        self.relief = self.slip_from[1] - self.extension
        self.top_speed = self.slip_from[2]
        self.count += 1
        if self.slipped >= 0.0:
            self.slipped += self.slip_time
        beyond = abs(self.force) > self.threshold * (1.0 + 4e-15)
        self.phase = (1 if self.force > 0.0 else -1) if beyond else 0
        self.slip_from = [self.position, self.extension, 0.0]
        self._new_arc(0.0)

    def _peak(self, age: float) -> None:
        """Remember the greatest speed of a slipping arc up to this age."""
        s = self.phase
        if s == 0:
            return
        w, u, v, _, angle = self._slip()
        radius = math.hypot(w * u, v - s * self.arc["speed"])
        # A slip without end passes its greatest speed once in each turn of the angle.
        if (math.pi - angle) % (2.0 * math.pi) <= w * age:
            top = v + radius
        else:
            top = max(s * self.arc["speed"], v - radius * math.cos(angle + w * age))
        if top > s * self.slip_from[2]:
            self.slip_from[2] = s * top
