"""Jobs as forks of one process: what they find loaded, how they end, and that nothing stays behind."""

import os
import signal
import time
from pathlib import Path
from threading import Thread

import psutil
import pytest

from corpus.jobs import ForkServer, Job, JobError

SCRIPTS = Path(__file__).parent.parent / "workflow" / "scripts"
MODULE = """
import os, time
LOADED_IN = os.getpid()

def gather(job):
    print("at work")
    exec(job.params.command)
    open(job.output.table, "w").write(f"{LOADED_IN} {os.getpid()} {os.getppid()}")
"""


@pytest.fixture
def server(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    Path("modules").mkdir()
    Path("modules/tiny_stage.py").write_text(MODULE)
    monkeypatch.setenv("PYTHONPATH", str(tmp_path / "modules"))
    return ForkServer(SCRIPTS, ["tiny_stage"])


def run(server, command="pass", name="a"):
    server.run("tiny_stage", Job.describe({}, {"table": f"{name}.txt"}, {"command": command}, f"logs/{name}.log", {}))
    return [int(word) for word in Path(f"{name}.txt").read_text().split()]


def wait_until(holds):
    begun = time.time()
    while not holds():
        assert time.time() < begun + 60
        time.sleep(0.01)


def test_jobs_are_forks_of_one_process_that_has_loaded_their_module(server):
    loaded, first, parent = run(server)
    assert loaded == parent != first
    again, second, _ = run(server, name="b")
    assert again == loaded and second != first
    assert Path("logs/a.log").read_text() == "at work\n"


def test_jobs_run_side_by_side(server):
    wait = "open('{0}', 'w')\nwhile not os.path.exists('{1}'): time.sleep(0.01)"
    threads = [Thread(target=run, args=(server, wait.format(*pair), pair[0])) for pair in ("xy", "yx")]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join(60)
    assert Path("x.txt").exists() and Path("y.txt").exists()


def test_what_ends_a_job_ends_no_other_and_is_told(server, capfd):
    loaded, *_ = run(server)
    with pytest.raises(JobError, match=r"tiny_stage came to no good end; its log is logs/b\.log"):
        run(server, "raise ValueError('there is no such thing')", "b")
    assert Path("logs/b.log").read_text().splitlines()[-1] == "This job ended: ValueError: there is no such thing"
    assert "logs/b.log: This job ended: ValueError: there is no such thing" in capfd.readouterr().err
    with pytest.raises(JobError):
        run(server, "os.kill(os.getpid(), 9)", "c")
    with pytest.raises(JobError):
        run(server, "os._exit(0)", "d")
    assert run(server)[0] == loaded


def test_a_module_that_cannot_be_loaded_is_told_by_its_job(server):
    Path("modules/tiny_stage.py").write_text("import no_such_package")
    with pytest.raises(JobError):
        run(server)
    assert "No module named 'no_such_package'" in Path("logs/a.log").read_text()


def test_another_process_takes_the_place_of_one_that_was_killed_and_its_jobs_end_with_it(server):
    loaded, *_ = run(server)
    failed = []

    def run_long():
        try:
            run(server, "open('started', 'w')\ntime.sleep(600)", "b")
        except JobError as error:
            failed.append(error)

    thread = Thread(target=run_long, daemon=True)
    thread.start()
    wait_until(Path("started").exists)
    (job,) = (each for each in psutil.Process(loaded).children() if each.status() != psutil.STATUS_ZOMBIE)
    os.kill(loaded, signal.SIGKILL)
    thread.join(60)
    wait_until(lambda: not job.is_running())
    assert "the process ended of which all jobs are forks" in str(failed[0])
    assert run(server)[0] != loaded


@pytest.mark.parametrize("held", [signal.default_int_handler, signal.SIG_IGN])
def test_jobs_take_an_interrupt_as_the_run_does(server, held):
    before = signal.signal(signal.SIGINT, held)
    try:
        command = "import signal\nopen('held', 'w').write(str(signal.getsignal(signal.SIGINT) is signal.SIG_IGN))"
        run(server, command)
    finally:
        signal.signal(signal.SIGINT, before)
    assert Path("held").read_text() == str(held is signal.SIG_IGN)


def test_nothing_stays_behind_a_process_that_is_killed(server):
    near, far = os.pipe()
    child = os.fork()
    if child == 0:
        try:
            os.write(far, b"%d" % run(server)[0])
            time.sleep(600)
        finally:
            os._exit(1)
    loaded = psutil.Process(int(os.read(near, 100)))
    os.kill(child, signal.SIGKILL)
    os.waitpid(child, 0)
    wait_until(lambda: not loaded.is_running() or loaded.status() == psutil.STATUS_ZOMBIE)
