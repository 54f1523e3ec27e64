"""Jobs of the add-on's own, which the engine's process runs: exports, and scores of variants."""

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path
from typing import Any, NamedTuple

from ..engine import advice, exchange, graphics, jobs, outputs, page, pe

OnProgress = Callable[[float], None]
SCORED_SHARE = 0.25
"""About which share of an export is done after the score."""
FIGURES_SHARE = 0.1  # About which share of a score's time its key figures take
PICTURE_PX = (320, 200)
PICTURE_TRIANGLES = 20_000
"""Of the picture of a variant: width and height, and triangles of its vehicle at most."""


@dataclass(frozen=True, slots=True)
class WrittenFiles:
    """Files that an export wrote, and warnings about them."""

    paths: tuple[Path, ...]
    lines: tuple[str, ...] = ()

    @property
    def text(self) -> str:
        """One line that names the written files, and their folder."""
        return f"Wrote {', '.join(path.name for path in self.paths)} in {self.paths[0].parent}"


class ExportStopped(Exception):
    """The user stopped the export; raised on the thread to end its work."""


class ExportJob(jobs.Job):
    """Makes files on a thread, then writes them; a stopped job writes nothing. `stage` is what it
    does. `make` gets an outcome, None if the study is not `scored` first, and a callback for the
    progress, 0 to 1; `write` writes what it returns."""

    def __init__(
        self,
        study: pe.Study,
        stage: str,
        make: Callable[[Any, OnProgress], Any],
        write: Callable[[Any], WrittenFiles],
        scored: bool = False,
    ) -> None:
        super().__init__(study)
        self._stage = stage
        self._make = make
        self._write = write
        self._scored = scored
        self.written: WrittenFiles | None = None

    def __iter__(self) -> Iterator[jobs.Progress]:
        score = jobs.ScoreJob(self.study)
        begin = SCORED_SHARE if self._scored else 0.0
        for step in score if self._scored else ():
            if self.stopped:
                score.drop()
            yield jobs.Progress("scoring", SCORED_SHARE * step.fraction)
        if self.stopped:
            return

        def work(watch: Callable[[float], bool]) -> Any:
            def note(share: float) -> None:
                if not watch(begin + (1.0 - begin) * share):
                    raise ExportStopped

            return self._make(score.outcome, note)

        made = yield from self._beside(work, jobs.Progress(self._stage, begin))
        if made is not None and not self.stopped:
            self.written = self._write(made)

    def stop(self) -> bool:
        """End at once, and write nothing."""
        self.drop()
        return super().stop()


def scene_job(
    study: pe.Study, output: str, path: Path, reach: float | None, replace: bool
) -> ExportJob:
    """Return the job that writes vehicle, sensors and fields of view as an output."""
    row = outputs.scene_output(output)
    make = partial(_scene_files, study, output, reach)
    write = partial(_write_scene, path, row.has_several, replace)
    return ExportJob(study, f"exporting {row.title}", make, write)


def _scene_files(
    study: pe.Study, output: str, reach: float | None, _outcome: None, _watch: OnProgress
) -> tuple[Mapping[str, bytes], list[str]]:
    return outputs.scene_files(study, output, reach)


def _write_scene(
    path: Path, inside: bool, replace: bool, made: tuple[Mapping[str, bytes], list[str]]
) -> WrittenFiles:
    files, lines = made
    paths = exchange.write_files(files, path, inside=inside, replace=replace)
    return WrittenFiles(tuple(paths), tuple(lines))


def rig_job(
    study: pe.Study,
    name: str,
    path: Path,
    into: str | None,
    replace: bool,
    result: Mapping[str, Any] | None = None,
) -> ExportJob:
    """Return the job that writes a study's rig in a format that has the figures of a result. A
    study without a `result` of it is scored."""
    stage = f"exporting {exchange.rig_format(name).title}"
    make = partial(_facts, study, result)
    write = partial(write_rig, study, name, path, into, replace)
    return ExportJob(study, stage, make, write, scored=result is None)


def _facts(
    study: pe.Study,
    result: Mapping[str, Any] | None,
    outcome: jobs.Outcome | None,
    _watch: OnProgress,
) -> exchange.SceneFacts:
    if outcome is not None:
        result = jobs.result_dict(outcome)
    assert result is not None
    return exchange.SceneFacts(study.vehicle, jobs.score_facts(result))


def write_rig(
    study: pe.Study,
    name: str,
    path: Path,
    into: str | None,
    replace: bool,
    facts: exchange.SceneFacts | None = None,
) -> WrittenFiles:
    """Write a study's rig in another program's format; `facts` are for those that have them."""
    paths, lines = exchange.export_rig(
        study.rig, name, path, study.reference, into=into, replace=replace, facts=facts
    )
    return WrittenFiles(tuple(paths), tuple(lines))


def picture_job(study: pe.Study, path: Path) -> ExportJob:
    """Return the job that scores a study and writes a picture of its rig."""
    return ExportJob(study, "picture", _picture, partial(_write_one, path), scored=True)


def _picture(outcome: jobs.Outcome, _watch: OnProgress) -> bytes:
    return page.picture_file(outcome.study, outcome)


class SearchedFrom(NamedTuple):
    """The study that a search began with, and the result of the search as plain data."""

    start: pe.Study
    data: Mapping[str, Any]


def page_job(
    study: pe.Study,
    path: Path,
    about: page.About,
    facts: dict[str, Any],
    search: SearchedFrom | None = None,
) -> ExportJob:
    """Return the job that scores a study and writes its review page: that of a search, if it is the
    result of one. `facts` are fields of the page's context, its name among them."""
    make = partial(_page, about, facts, search)
    return ExportJob(study, "page", make, partial(_write_one, path), scored=True)


def _page(
    about: page.About,
    facts: dict[str, Any],
    search: SearchedFrom | None,
    outcome: jobs.Outcome,
    watch: OnProgress,
) -> bytes:
    shown = outcome if search is None else _searched(outcome, search)
    return page.page_bytes([page.ReportContext(outcome=shown, **facts)], watch, about)


def _searched(outcome: jobs.Outcome, search: SearchedFrom) -> jobs.Outcome:
    """Return the outcome of the search that a scored study is the result of."""
    job = jobs.ScoreJob(search.start)
    for _ in job:
        pass
    first = job.outcome
    if first is None:
        return outcome
    before = first.figures_after
    after = outcome.figures_after
    return replace(
        outcome,
        kind=search.data["kind"],
        start=search.start,
        before=first.after,
        figures=None if before is None or after is None else (before, after),
        evaluations=search.data["evaluations"],
        stopped=search.data["stopped"],
        stop_reason=search.data["stop_reason"] or "",
    )


def _write_one(path: Path, made: bytes) -> WrittenFiles:
    with jobs.FileSet(path.parent, (path.name,)) as files:  # the dialog has confirmed it
        files.add(path.name, made)
    return WrittenFiles((path,))


class PendingVariant(NamedTuple):
    """A variant without a valid score, or without key figures."""

    name: str
    study: pe.Study
    unscored: bool


class ComparedVariant(NamedTuple):
    """The results of a variant; `score` is None where it has a valid one already."""

    score: pe.Score | None
    figures: advice.KeyFigures
    picture: bytes


def _small_picture(study: pe.Study) -> bytes:
    vehicle = study.vehicle
    if vehicle is not None:
        vehicle, _ = graphics.simplified(vehicle, PICTURE_TRIANGLES, quick=True)
    return page.vehicle_picture(vehicle, study.rig, PICTURE_PX, marked=True)


class CompareJob(jobs.Job):
    """A job of several studies, one after the other: their scores and key figures, by key."""

    def __init__(self, lacking: dict[int, PendingVariant]) -> None:
        super().__init__(next(iter(lacking.values())).study)
        self.lacking = lacking
        self.compared: dict[int, ComparedVariant] | None = None

    def __iter__(self) -> Iterator[jobs.Progress]:
        compared: dict[int, ComparedVariant] = {}
        for key, (name, study, unscored) in self.lacking.items():
            score = known = None
            if unscored:
                job = jobs.ScoreJob(study)
                for step in job:
                    if self.stopped:
                        job.stop()
                    yield self._progress(name, len(compared), step)
                if job.outcome is None:
                    break
                score = job.outcome.after
                known = job.outcome.figures_after
            if self.stopped and score is None:
                break
            looking = jobs.Progress("seeing", 1.0 - FIGURES_SHARE)
            yield self._progress(name, len(compared), looking)
            picture = _small_picture(study)
            compared[key] = ComparedVariant(score, study.key_figures(known), picture)
        self.compared = None if self.dropped else compared or None

    def _progress(self, name: str, done: int, step: jobs.Progress) -> jobs.Progress:
        share = (done + step.fraction) / len(self.lacking)
        return replace(step, stage=f"scoring {name}", fraction=min(share, 1.0))
