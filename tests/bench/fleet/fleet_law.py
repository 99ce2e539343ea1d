#!/usr/bin/env python3
"""Prints the measurements of a fleet side by side, the law that is fitted to them, and what the law says of a larger fleet.
usage: fleet_law.py RESULTS.txt...      files of fleet_bench.sh, with lines "NAME VALUE"

Everything that is not a measured figure is an assumption, which is printed beside what follows from it."""
import sys

DOORS, PEOPLE = 100_000, 100_000  # the fleet of the extrapolation
CHANGES_A_DAY = PEOPLE // 100
VISITS_A_DAY = 4 * PEOPLE
QUESTION_S = 60  # of a door at rest, with a lease of a day
SLOWEST_CONNECTION_S = 64  # the longest wait of a link before it connects again (link_mqtt.h)
TEMPLATE_BYTES = 10_000  # of a person (fleet_change.c)
DAY_S = 86_400
PARTS = ["broker", "hub", "postgres", "doors"]


def read(path):
    with open(path, encoding="ascii") as lines:
        return {name: float(value) for name, value in (line.split() for line in lines if line.strip())}


def fit(xs, ys):
    """The straight line a + b x with the least squares, and the largest distance from it as a share of the largest value."""
    n, mean_x, mean_y = len(xs), sum(xs) / len(xs), sum(ys) / len(ys)
    spread = sum((x - mean_x) ** 2 for x in xs)
    b = sum((x - mean_x) * (y - mean_y) for x, y in zip(xs, ys)) / spread if n > 1 and spread else mean_y / mean_x
    a = mean_y - b * mean_x if n > 1 else 0.0
    off = max(abs(a + b * x - y) for x, y in zip(xs, ys))
    return a, b, off / max(abs(y) for y in ys) if any(ys) else 0.0


def number(value):
    return "-" if value is None else f"{value:,.0f}" if abs(value) >= 100 else f"{value:.3g}"


def row(text, sizes, name, factor=1.0):
    print(f"| {text} | " + " | ".join(number(s[name] * factor if name in s else None) for s in sizes) + " |")


def spread_row(text, sizes, prefix, ranks=("p50", "p99", "max"), factor=1.0):
    cells = [" / ".join(number(s[f"{prefix}_{rank}"] * factor) if f"{prefix}_{rank}" in s else "-" for rank in ranks) for s in sizes]
    print(f"| {text} | " + " | ".join(cells) + " |")


def parts_row(text, sizes, prefix, parts=PARTS):
    print(f"| {text} | " + " | ".join(" / ".join(number(s.get(f"{prefix}_{part}")) for part in parts) for s in sizes) + " |")


def question_cost(s, part):
    """Processor time at rest, which is that of questions, for each of them in microseconds."""
    return s[f"idle_cpu_us_{part}"] * s["doors"] / s["idle_questions_a_second"]


def measured(sizes):
    print("| doors | " + " | ".join(number(s["doors"]) for s in sizes) + " |")
    print("| --- |" + " --- |" * len(sizes))
    row("joins a second, without HTTPS", sizes, "join_a_second")
    spread_row("all doors connect at once: s until the lease, p50 / p99 / max", sizes, "start_online_s")
    row("connected in the busiest second", sizes, "start_most_a_second")
    parts_row("memory, MB: broker / hub / PostgreSQL / all doors", sizes, "memory_mb")
    row("at rest: questions a second", sizes, "idle_questions_a_second")
    row("at rest: bytes a door and minute", sizes, "idle_bytes_a_minute")
    for s in sizes:
        s.update((f"question_cpu_us_{part}", question_cost(s, part)) for part in PARTS)
    parts_row("at rest, for each question: us of processor: broker / hub / PostgreSQL / door", sizes, "question_cpu_us")
    spread_row("revocation at the doors, ms: p50 / p99 / p99.9 / max", sizes, "revoke_ms", ("p50", "p99", "p999", "max"))
    spread_row("revocation confirmed by all doors in the database, s: p50 / max", sizes, "revoke_confirmed_s", ("p50", "max"))
    row("a revocation: bytes a door", sizes, "revoke_bytes")
    parts_row("a revocation: us of processor a door: broker / hub / PostgreSQL / door", sizes, "revoke_cpu_us")
    row("enrolments a second into the database", sizes, "enrol_stored_a_second")
    row("enrolments a second at all doors", sizes, "enrol_at_all_doors_a_second")
    row("that is deliveries a second", sizes, "enrol_deliveries_a_second")
    parts_row("an enrolment: us of processor a door: broker / hub / PostgreSQL / door", sizes, "enrol_cpu_us")
    row("one visit at every door: events a second", sizes, "visit_a_second")
    row("several visits at every door at once: how many", sizes, "visits_each")
    row("events a second", sizes, "visits_a_second")
    row("events more than there were", sizes, "visits_surplus")
    spread_row("broker away for 20 s: s until the lease, p50 / p99 / max", sizes, "broker_outage_online_s")
    row("connected in the busiest second", sizes, "broker_outage_most_a_second")
    spread_row("s until a revocation of that time is at the doors, p50 / p99 / max", sizes, "broker_outage_level_s")
    parts_row("processors in the busiest second: broker / hub / PostgreSQL / doors", sizes, "broker_outage_most_cpu")
    spread_row("hub away for 20 s: s until a revocation of that time is at the doors, p50 / p99 / max", sizes, "hub_outage_level_s")
    row("messages that a door has refused", sizes, "faults")
    for interval in (5, 1):
        poll = f"poll{interval}"
        spread_row(f"naive, a poll each {interval} s: ms until the doors know, p50 / p99 / max", sizes, f"{poll}_ms")
        row("naive: polls a second that were made", sizes, f"{poll}_a_second")
        row("naive: polls a second that there should have been", sizes, f"{poll}_wanted_a_second")
        for s in sizes:
            if f"{poll}_cpu_s" in s:
                s[f"{poll}_cpu"] = s[f"{poll}_cpu_s"] / s[f"{poll}_s"]
        row("naive: processors of PostgreSQL", sizes, f"{poll}_cpu")
    for s in sizes:
        s["own_cpu"] = 1e-6 * s["idle_cpu_us_postgres"] * s["doors"]
    row("for comparison, the hub at rest: processors of PostgreSQL", sizes, "own_cpu")


def law(sizes):
    """Fits a straight line over the doors to each figure, prints it, and returns the lines."""
    doors = [s["doors"] for s in sizes]
    figures = [("memory of the broker, MB", "memory_mb_broker", 1, False), ("memory of the hub, MB", "memory_mb_hub", 1, False)]
    figures += [(f"a revocation: processor s of {part}", f"revoke_cpu_us_{part}", 1e-6, True) for part in PARTS]
    figures += [(f"an enrolment: processor s of {part}", f"enrol_cpu_us_{part}", 1e-6, True) for part in ("broker", "hub")]
    figures += [(f"all doors connect: processor s of {part}", f"start_cpu_us_{part}", 1e-6, True) for part in PARTS[:3]]
    figures += [("revocation, s: p50", "revoke_ms_p50", 1e-3, False), ("revocation, s: max", "revoke_ms_max", 1e-3, False)]
    print("\n| y = a + b x doors | a | b | off by at most |\n| --- | --- | --- | --- |")
    lines = {}
    for text, name, factor, is_each in figures:
        a, b, off = fit(doors, [s[name] * factor * (s["doors"] if is_each else 1) for s in sizes])
        lines[name] = (a, b)
        print(f"| {text} | {a:.3g} | {b:.3g} | {100 * off:.0f} % |")
    return lines


def extrapolate(lines, sizes):
    def at(name):
        a, b = lines[name]
        return a + b * DOORS

    largest = sizes[-1]
    print(f"\n{DOORS:,} doors and {PEOPLE:,} people, if the lines go on:\n")
    print(f"- Assumed: one zone, so every change goes to every door; {CHANGES_A_DAY:,} changes and {VISITS_A_DAY:,} visits a day; a lease of a day, so "
          f"a door asks each {QUESTION_S} s; processors like this one; each door verifies on a processor of its own.")
    print(f"- Questions: {DOORS / QUESTION_S:,.0f} a second at rest.")
    print(f"- Deliveries: {DOORS * CHANGES_A_DAY:,} changes a day, {DOORS * CHANGES_A_DAY / DAY_S:,.0f} a second on average.")
    print(f"- Sessions: the broker needs {at('memory_mb_broker') / 1000:.1f} GB and {DOORS:,} descriptors (LimitNOFILE).")
    for part in PARTS[:3]:
        rest, change = 1e-6 * question_cost(largest, part) * DOORS / QUESTION_S, at(f"revoke_cpu_us_{part}")
        print(f"- {part}: {rest:.2f} processors at rest; {change:.0f} processor seconds for a change, "
              f"{change * CHANGES_A_DAY / DAY_S:.2f} processors for all of the day.")
    busiest = max(largest["visit_a_second"], largest["visits_a_second"])
    print(f"- Events: {VISITS_A_DAY / DAY_S:.1f} a second on average, ten times as many in the busiest hour; the database took {busiest:,.0f} a second here.")
    delivery = lines["enrol_cpu_us_broker"][1]
    print(f"- Revocation: the last door gets it after about {DOORS * delivery:.1f} s, for which one broker is busy ({1e6 * delivery:.0f} us a delivery with "
          f"what answers it); the line through the delays of this machine, where the doors share its processors, says {at('revoke_ms_max'):.0f} s.")
    for part in PARTS[:3]:
        print(f"- All doors at once: {at(f'start_cpu_us_{part}'):.0f} processor seconds of {part}; the links spread them over up to {SLOWEST_CONNECTION_S} s.")
    whole = PEOPLE * TEMPLATE_BYTES
    print(f"- A new door: a snapshot of {whole / 1e9:.1f} GB at {TEMPLATE_BYTES:,} bytes a person; all doors at once {DOORS * whole / 1e12:,.0f} TB, "
          f"{DOORS * whole * 8 / 1e9 / DAY_S:.0f} days at 1 Gbit/s: so people belong to the zones of their doors, not to all.")
    print(f"- With zones of 1,000 doors a change costs a hundredth, and brokers may have a part of the zones each.")


def main():
    sizes = sorted((read(path) for path in sys.argv[1:]), key=lambda s: s["doors"])
    if not sizes:
        sys.exit(__doc__)
    measured(sizes)
    if len(sizes) > 1:
        extrapolate(law(sizes), sizes)
    else:
        print("\nOne size is no line: the law needs at least two.")


main()
