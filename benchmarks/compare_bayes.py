#!/usr/bin/python3
"""Posteriors: speed of the whole command on a shell of 20,532 equations, Mottle's sampler beside emcee, OpenTURNS and R's mcmc on
the two-storey frame of Beck and Au, and what gradients cost and bring by the number of parameters. Writes BAYES.md beside this file.

    cmake --preset release -DMOTTLE_BUILD_BENCHMARKS=ON && cmake --build --preset release --target mottle_app mottle_posterior_benchmark
    benchmarks/compare_bayes.py [shell] [peers] [gradients]

Needs python3-emcee, python3-openturns, r-base-core, r-cran-mcmc and r-cran-posterior. Takes about four minutes. Without words all
three sections are measured; with words only those, and the others keep their text.
"""
import datetime
import json
import pathlib
import re
import subprocess
import sys
import tempfile
import time

import peers

peers.use_one_core()
peers.choose_blas_kernels()

import numpy  # noqa: E402

HERE = pathlib.Path(__file__).resolve().parent
BUILD = HERE.parent / "build" / "release"
PROGRAM = BUILD / "benchmarks" / "mottle_posterior_benchmark"
MOTTLE = BUILD / "mottle"
EVALUATIONS = 200000  # of each sampler, about
LN_EVIDENCE = numpy.log(1.50950476e-3)

STUDY = """title = "Shell"
units = "SI"
seed = 3
[model]
kind = "nastran"
file = "shell.bdf"
%s
[outputs]
frequencies = [1, 2, 3, 4, 5, 6, 7, 8, 9, 10]
[test]
file = "specimens.csv"
repeatability = { "f*" = %s }
[update]
method = "bayes"
samples = 200
"""
PARAMETER = """[[parameter]]
name = "E%d"
target = "MAT1:%d:E"
distribution = { kind = "lognormal", mean = 7e10, std = 7e9 }
"""
TRUTH = """[truth]
specimens = 1
population = { mean = { E1 = 7.3e10, E2 = 6.8e10, E3 = 7.2e10, E4 = 6.5e10, E5 = 7.4e10 } }
"""


def run(*words, folder=None):
    done = subprocess.run([str(word) for word in words], cwd=folder, capture_output=True, text=True, check=False)
    if done.returncode != 0:
        sys.exit(f"{' '.join(map(str, words))} ended with {done.returncode}: {done.stderr}")
    return done.stdout


def shell():
    rows = []
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        run(HERE / "make_models.py", "shell", 20000, 5, folder / "shell.bdf")
        (folder / "points.csv").write_text("E1,E2,E3,E4,E5\n7.3e10,6.8e10,7.2e10,6.5e10,7.4e10\n")
        parameters = "".join(PARAMETER % (i, i) for i in range(1, 6))
        (folder / "study.toml").write_text(STUDY % (parameters, '"0.2 %"'))
        (folder / "specimens.csv").write_text(",".join(f"f{k}" for k in range(1, 11)) + "\n" + ",".join(["1.0"] * 10) + "\n")
        run(MOTTLE, "propagate", "study.toml", "--points", "points.csv", "--out", "truth", "--quiet", folder=folder)
        header, values = (folder / "truth" / "cloud.csv").read_text().splitlines()[:2]
        tested = dict(zip(header.split(","), values.split(",")))
        names = [f"f{i}" for i in range(1, 11)]
        (folder / "specimens.csv").write_text(",".join(names) + "\n" + ",".join(tested[n] for n in names) + "\n")
        for noise, particles in (("1 %", 400), ("1 %", 640), ("1 %", 1000), ("0.2 %", 1000)):
            (folder / "study.toml").write_text(STUDY % (parameters, f'"{noise}"') + f"[update.bayes]\nparticles = {particles}\n")
            start = time.perf_counter()
            run("/usr/bin/time", "-f", "%U %S", "-o", "time.txt", MOTTLE, "update", "study.toml", "--out", "out", "--threads", 1,
                "--cache", "off", "--quiet", folder=folder)
            elapsed = time.perf_counter() - start
            processor = sum(map(float, (folder / "time.txt").read_text().split()[-2:]))
            result = json.loads((folder / "out" / "result.json").read_text())
            posterior = result["posterior"]
            rows.append(f"| {noise} | {particles} | {posterior['model_evaluations']} | {processor:.1f} | "
                        f"{1e5 * processor / posterior['model_evaluations']:.1f} | {elapsed:.1f} | "
                        f"{min(posterior['ess_bulk']):.0f} | {result['evidence']['standard_error']:.3f} | {result['status']} |")
    return ("A cylindrical panel of 20,532 equations (make_models.py), Young's moduli of five strips log-normal with 10 %, one test of ten "
            "frequencies, eight islands. Times are of the whole command, with the training of the reduced model and all tests.\n\n"
            "| noise | particles of an island | model evaluations | processor s | s for 100,000 | elapsed s | least bulk ESS | "
            "standard error of ln evidence | status |\n|---|---|---|---|---|---|---|---|---|\n" + "\n".join(rows))


# The two-storey frame, for the peers: ln of prior times likelihood of ln-factors, [point x 2] -> [point].
LOG_MEAN, LOG_STD = numpy.array([0.5102367348, 0.1695776862]), numpy.array([0.4978679246, 0.6266747461])


def log_posterior(scores):
    theta = numpy.exp(LOG_MEAN + LOG_STD * scores)
    a = (theta[:, 0] + theta[:, 1]) * 29.7e6 / 16.5e3
    b = theta[:, 1] * 29.7e6 / 16.1e3
    half = 0.5 * (a + b)
    product = theta[:, 0] * theta[:, 1] * 29.7e6**2 / (16.5e3 * 16.1e3)
    high = half + numpy.sqrt(half * half - product)
    first = product / high / (2 * numpy.pi * 3.13) ** 2 - 1
    second = high / (2 * numpy.pi * 9.83) ** 2 - 1
    return -(first**2 + second**2) / (2 * 0.5**8) - 0.5 * (scores**2).sum(1)


def of_mottle(folder):
    found = json.loads(run(PROGRAM, "beck-au", 901, folder / "mottle.csv"))
    return found["seconds"], found["evaluations"], f"{found['ln_evidence']:.3f} +- {found['standard_error']:.3f}"


def write_draws(file, chains):
    """[draw x chain x 2] scores -> parameters"""
    theta = numpy.exp(LOG_MEAN + LOG_STD * chains)
    with open(file, "w", encoding="ascii") as out:
        out.write("chain,a,b\n")
        for c in range(theta.shape[1]):
            out.writelines(f"{c + 1},{a:.10g},{b:.10g}\n" for a, b in theta[:, c])


def of_emcee(folder, moves):
    import emcee
    walkers = 100
    numpy.random.seed(1)
    sampler = emcee.EnsembleSampler(walkers, 2, log_posterior, vectorize=True, moves=[
        (emcee.moves.DEMove(), 0.8), (emcee.moves.DESnookerMove(), 0.2)] if moves else None)
    start = time.process_time()
    state = sampler.run_mcmc(numpy.random.standard_normal((walkers, 2)), EVALUATIONS // walkers // 5)  # burn-in
    sampler.reset()
    sampler.run_mcmc(state, EVALUATIONS // walkers * 4 // 5)
    seconds = time.process_time() - start
    write_draws(folder / f"emcee{int(moves)}.csv", sampler.get_chain())
    return seconds, EVALUATIONS, "none"


def of_openturns(folder):
    import openturns
    openturns.RandomGenerator.SetSeed(1)
    # The same function in OpenTURNS' own compiled expressions.
    body = ("var t1 := exp(0.5102367348 + 0.4978679246 * u1); var t2 := exp(0.1695776862 + 0.6266747461 * u2);"
            "var a := (t1 + t2) * 1800; var b := t2 * 29.7e6 / 16.1e3; var h := 0.5 * (a + b);"
            "var p := t1 * t2 * 29.7e6 * 29.7e6 / (16.5e3 * 16.1e3); var high := h + sqrt(h * h - p);"
            "var e1 := p / high / (6.283185307179586 * 3.13)^2 - 1; var e2 := high / (6.283185307179586 * 9.83)^2 - 1;"
            "y := -(e1 * e1 + e2 * e2) * 128 - 0.5 * (u1 * u1 + u2 * u2)")
    density = openturns.SymbolicFunction(["u1", "u2"], ["y"], body)
    at = numpy.array([[0.3, -0.2], [-1.0, 0.5]])
    assert numpy.allclose([density(point)[0] for point in at], log_posterior(at))
    chains, draws, seconds = 8, EVALUATIONS // 8, 0.0
    found = []
    for c in range(chains):
        support = openturns.Interval([-10.0, -10.0], [10.0, 10.0])
        start = time.process_time()
        sampler = openturns.RandomWalkMetropolisHastings(density, support, openturns.Normal(2).getRealization(),
                                                         openturns.Normal([0.0, 0.0], [0.6, 0.6], openturns.CorrelationMatrix(2)))
        sampler.setBurnIn(draws // 5)
        chain = sampler.getSample(draws * 4 // 5)
        seconds += time.process_time() - start
        found.append(numpy.array(chain))
    write_draws(folder / "openturns.csv", numpy.stack(found, 1))
    return seconds, EVALUATIONS, "none"


MCMC = r"""
library(mcmc)
mean <- c(0.5102367348, 0.1695776862); std <- c(0.4978679246, 0.6266747461)
log_posterior <- function(u) {
  t <- exp(mean + std * u)
  a <- (t[1] + t[2]) * 29.7e6 / 16.5e3; b <- t[2] * 29.7e6 / 16.1e3; h <- 0.5 * (a + b)
  p <- t[1] * t[2] * 29.7e6^2 / (16.5e3 * 16.1e3); high <- h + sqrt(h * h - p)
  e1 <- p / high / (2 * pi * 3.13)^2 - 1; e2 <- high / (2 * pi * 9.83)^2 - 1
  -(e1^2 + e2^2) * 128 - 0.5 * sum(u^2)
}
set.seed(1)
arguments <- commandArgs(TRUE); draws <- as.integer(arguments[1])
out <- file(arguments[2], "w"); writeLines("chain,a,b", out); seconds <- 0
for (chain in 1:8) {
  start <- proc.time()[1]
  first <- metrop(log_posterior, rnorm(2), draws %/% 5, scale = 0.6)
  rest <- metrop(first, nbatch = (draws * 4) %/% 5)
  seconds <- seconds + proc.time()[1] - start
  theta <- exp(t(mean + std * t(rest$batch)))
  writeLines(sprintf("%d,%.10g,%.10g", chain, theta[, 1], theta[, 2]), out)
}
close(out); cat(seconds)
"""
ESS = r"""
library(posterior)
for (file in commandArgs(TRUE)) {
  d <- read.csv(file); n <- nrow(d) / max(d$chain)
  of <- function(x) ess_bulk(matrix(x, nrow = n)); r <- function(x) rhat(matrix(x, nrow = n))
  cat(min(of(d$a), of(d$b)), max(r(d$a), r(d$b)), mean(d$a), sd(d$a), "\n")
}
"""


def of_mcmc(folder):
    (folder / "mcmc.R").write_text(MCMC)
    seconds = float(run("Rscript", "mcmc.R", EVALUATIONS // 8, "mcmc.csv", folder=folder))
    return seconds, EVALUATIONS, "none"


def side_by_side():
    contenders = {"Mottle": ("mottle", of_mottle), "emcee, stretch moves": ("emcee0", lambda f: of_emcee(f, False)),
                  "emcee, differential evolution": ("emcee1", lambda f: of_emcee(f, True)),
                  "OpenTURNS, random walk": ("openturns", of_openturns), "R mcmc, random walk": ("mcmc", of_mcmc)}
    rows = []
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        (folder / "ess.R").write_text(ESS)
        for title, (stem, sample) in contenders.items():
            seconds, evaluations, evidence = sample(folder)
            ess, r_hat, mean, std = map(float, run("Rscript", "ess.R", f"{stem}.csv", folder=folder).split())
            rows.append(f"| {title} | {evaluations} | {seconds:.2f} | {ess:.0f} | {ess / seconds:.0f} | {1000 * ess / evaluations:.1f} | "
                        f"{r_hat:.4f} | {mean:.3f} | {std:.3f} | {evidence} |")
    return ("Each has about 200,000 evaluations, a fifth of them for burn-in where it needs one. Peers work in the same standard normal "
            "coordinates; emcee with 100 walkers and the likelihood as one NumPy expression of all of them, OpenTURNS with its compiled expressions, 8 chains of "
            "a step whose acceptance is near 0.3, R's `metrop` likewise with a function in R. Bulk effective sample sizes, the smaller of the two parameters', "
            f"and R-hat of all by R's `posterior`. By quadrature: mean 1.117, standard deviation 0.662, ln evidence {LN_EVIDENCE:.3f}.\n\n"
            "| sampler | evaluations | processor s | bulk ESS | ESS / s | ESS / 1,000 evaluations | R-hat | mean of a | sd of a | ln evidence |\n"
            "|---|---|---|---|---|---|---|---|---|---|\n" + "\n".join(rows))


def gradients():
    rows = []
    for springs in (5, 10, 15, 20, 30):
        for moves in ("never", "always"):
            r = json.loads(run(PROGRAM, "chain", springs, moves))
            rows.append(f"| {springs} | {'yes' if moves == 'always' else 'no'} | {r['evaluations']} | {r['gradients']} | {r['seconds']:.1f} | {r['ess']:.0f} | "
                        f"{r['ess'] / r['seconds']:.0f} | {r['ln_evidence']:.3f} +- {r['standard_error']:.3f} | {r['r_hat']:.4f} | {r['status']} |")
    return ("A chain of springs (tests/support/spring_chain.hpp), eight frequencies with 0.5 % noise, default options. By importance sampling "
            "(validation/bayes/chain.py) ln evidence of 30 springs is 21.052 +- 0.004.\n\n"
            "| parameters | gradients | evaluations | of them with gradient | processor s | least bulk ESS | ESS / s | ln evidence | R-hat | status |\n"
            "|---|---|---|---|---|---|---|---|---|---|\n" + "\n".join(rows))


SECTIONS = {"shell": ("A shell of 20,532 equations", shell), "peers": ("Beside other samplers", side_by_side),
            "gradients": ("Gradients", gradients)}


def main():
    wanted = sys.argv[1:] or list(SECTIONS)
    target = HERE / "BAYES.md"
    old = dict(re.findall(r"^## ([^\n]+)\n\n(.*?)(?=\n\n## |\Z)", target.read_text() if target.exists() else "", re.S | re.M))
    texts = []
    for word, (title, measure) in SECTIONS.items():
        texts.append(f"## {title}\n\n" + (measure() if word in wanted else old.get(title, "Not measured.").strip()))
    target.write_text(f"# Posteriors\n\n{datetime.date.today()}; made by compare_bayes.py on one core of {peers.processor()}.\n\n" + "\n\n".join(texts) + "\n")
    print(target.read_text())


if __name__ == "__main__":
    main()
