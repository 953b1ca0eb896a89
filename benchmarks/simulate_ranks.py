#!/usr/bin/python3
"""How long jobs take by 1 to 10,000 ranks, by a simulation with the costs that compare_ranks.py has measured (ranks.json).

    benchmarks/simulate_ranks.py [PAGE]     writes its tables between the marks of PAGE (default: docs/howto/scaling.md)

A batch: every rank asks rank 0 for a number, waits for the answer, does that chunk, asks again; rank 0 serves the
questions one after the other. Once no number is left, the rows are gathered: Open MPI sends them from each rank to each,
hence a message a rank, and all bytes. Then comes what every rank does by itself, in proportion to the samples. Not simulated: the launcher,
the reading of the model, a file system that is shared, a network slower than the memory that was measured.
"""
import heapq
import json
import math
import pathlib
import random
import sys

HERE = pathlib.Path(__file__).resolve().parent
COSTS = json.loads((HERE / "ranks.json").read_text())
MESSAGES = COSTS["messages"]
RANKS = (1, 10, 100, 1000, 10000)
CHUNK = 64             # samples of a piece of a cloud through a reduced model
ROW_BYTES = 400        # of a sample: ten modes with their numbers, bounds and shape components
VARIATION = 0.2        # coefficient of variation of solvers' durations


def serial_part(case):
    """Of a measured job, in s, by Amdahl's law: T_n = serial + (T_1 - serial) / 2."""
    return max(2.0 * case["threads"] - case["one"], 0.0)


def serial_of_sample():
    case = COSTS["cases"]["cloud"]
    return serial_part(case) / case["samples"]


def chunk_durations(count, seconds, variation, random_stream):
    """Lognormal, of the given mean."""
    sigma = math.sqrt(math.log1p(variation**2))
    return [seconds * math.exp(sigma * random_stream.gauss(0.0, 1.0) - sigma**2 / 2.0) for _ in range(count)]


def batch_time(ranks, durations, samples):
    """From the first question of a batch to the rows on every rank."""
    if ranks == 1:
        return sum(durations)
    travel = MESSAGES["counter_latency"] / 2.0
    questions = [(0.0 if rank == 0 else travel, rank) for rank in range(ranks)]  # when they reach rank 0
    heapq.heapify(questions)
    served, end, given = 0.0, 0.0, 0
    while questions:
        arrival, rank = heapq.heappop(questions)
        # Rank 0 asks itself without a message.
        served = max(arrival, served) + MESSAGES["counter_service"] if rank else served
        answered = served + travel if rank else arrival
        if given < len(durations):
            done = answered + durations[given]
            given += 1
            heapq.heappush(questions, (done + (travel if rank else 0.0), rank))
            end = max(end, done)
        else:
            end = max(end, answered)
    return end + ranks * MESSAGES["gather"] + samples * ROW_BYTES * MESSAGES["gather_byte"]


class Job:
    """Batches one after the other, of samples that are a piece each; `seconds`: of a sample."""

    def __init__(self, title, batches, samples, seconds, variation):
        self.title, self.batches, self.samples = title, batches, samples
        self.seconds, self.variation = seconds, variation

    def time(self, ranks):
        random_stream = random.Random(1)
        total = 0.0
        for _ in range(self.batches):
            durations = chunk_durations(self.samples, self.seconds, self.variation, random_stream)
            total += batch_time(ranks, durations, self.samples) + self.samples * serial_of_sample()
        return total


def measured_jobs():
    """The jobs that were measured, with the costs of a sample that one thread showed."""
    for key, title, chunk in (("cloud", "airframe, certified reduced model", CHUNK), ("full", "airframe, solved in full", 1),
                              ("runs", "runs of a solver of 0.1 s", 1)):
        case = COSTS["cases"][key]
        serial = serial_part(case)
        seconds = (case["one"] - serial) / case["samples"]
        durations = [seconds * chunk] * math.ceil(case["samples"] / chunk)
        yield title, batch_time(2, durations, case["samples"]) + serial, case["ranks"]


def jobs():
    return [Job("7 batches of 1,000 runs of 10 min", 7, 1000, 600.0, VARIATION),
            Job("7 batches of 10,000 runs of 1 min", 7, 10000, 60.0, VARIATION),
            Job("7 batches of 10,000 solutions of 1 s", 7, 10000, 1.0, VARIATION)]


def duration(seconds):
    if seconds < 100.0:
        return f"{seconds:.3g} s"
    if seconds < 6000.0:
        return f"{seconds / 60.0:.0f} min"
    return f"{seconds / 3600.0:.0f} h" if seconds < 48 * 3600.0 else f"{seconds / 86400.0:.0f} d"


def speed_up(ratio):
    return f"{ratio:.2g}" if ratio < 10.0 else f"{ratio:.0f}"


def tables():
    yield f"| job | {' | '.join(f'{ranks:,}' for ranks in RANKS)} |"
    yield "|---|" + "---|" * len(RANKS)
    for job in jobs():
        one = job.time(1)
        cells = [duration(one)] + [f"{duration(time)} ({speed_up(one / time)})" for time in map(job.time, RANKS[1:])]
        yield f"| {job.title} | {' | '.join(cells)} |"
    yield ""
    yield "The simulation against the measurement, two ranks:"
    yield ""
    yield "| job | simulated, s | measured, s |"
    yield "|---|---|---|"
    for title, simulated, measured in measured_jobs():
        yield f"| {title} | {simulated:.2f} | {measured:.2f} |"


def main():
    page = pathlib.Path(sys.argv[1] if len(sys.argv) > 1 else HERE.parent / "docs" / "howto" / "scaling.md")
    begin, end = "<!-- by benchmarks/simulate_ranks.py -->\n", "<!-- end -->\n"
    before, rest = page.read_text(encoding="utf-8").split(begin)
    after = rest.split(end)[1]
    page.write_text(before + begin + "\n".join(tables()) + "\n" + end + after, encoding="utf-8")


if __name__ == "__main__":
    main()
