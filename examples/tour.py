"""What the commands of the README do, from Python; `python -m examples.tour` runs it."""

import stickslip as ss

if __name__ == "__main__":
    p = ss.Parameters(v="20 mm/s", k="1 kN/m", c="2 N.s/m")
    print(ss.cycle(p).exact.delta_x, ss.critical(p).velocities.cycle)
    run = ss.simulate(p, "10 s")
    run.write_csv("run.csv")
    run.write_plot("run.png")
    fmu = ss.build("build")
    print(ss.verify(fmu, cases="one-step").passed)
    print(ss.score("run.csv", p).score.explanation)
    print(ss.design("axis.toml").report("axis.html"))
    chart = ss.map({"v": "1..200 mm/s log 12", "k": "0.1..10 kN/m log 8"}, p)
    chart.stickslip.plot().savefig("chart.png")
    print(ss.scatter("axis.toml", samples=1000, vary={"axis.mass": "± 10 %"}).probability)
    plan = {"stop_time": "2 s", "parameters": {"mu_s": [0.4, 0.5]}, "outputs": {"x": ["jump"]}}
    print(ss.sweep(fmu, plan)["x.jump"])
