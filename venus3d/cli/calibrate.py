"""`venus3d calibrate`: pictures or a video that exist already, without guidance."""

from __future__ import annotations

from collections.abc import Sequence

from venus3d.cli.options import CalibrateOptions
from venus3d.cli.report import deliver, print_result, tell, write_first
from venus3d.engine.calibration.adjustment import calibrate
from venus3d.engine.calibration.checks import diagnose
from venus3d.engine.calibration.detection import Detector
from venus3d.engine.calibration.diagnosis import Diagnosis, worst_first
from venus3d.engine.calibration.observation import Observation
from venus3d.engine.calibration.view_selection import choose_informative
from venus3d.engine.errors import CalibrationError, VenusError
from venus3d.sources.observing import observe_recording
from venus3d.storage.folder import prepare
from venus3d.storage.result import summary_of
from venus3d.storage.result_folder import ResultFolder

FEWEST_VIEWS = 3
"""Two views determine nine parameters on paper only; three can contradict each other."""


def calibrate_command(options: CalibrateOptions) -> None:
    """Detect, calibrate, print, write. Raises `VenusError` for a user's mistake."""
    detector = Detector(options.board.board())
    if options.max_frames < FEWEST_VIEWS:
        raise VenusError(f"--max-frames must be at least {FEWEST_VIEWS}.")
    if options.every is not None and options.every < 1:
        raise VenusError("--every must be at least 1.")
    if options.output is not None:
        prepare(options.output)
    recording = observe_recording(
        options.source, detector, lambda count: tell(f"{count} frames looked at ...")
    )
    observations, is_video = recording.observations, recording.is_video
    warnings = [*recording.notes, *detector.notes]
    seen = [o for o in observations if o.count]
    if is_video:
        if options.every is None:
            chosen = choose_informative(detector.board, seen, limit=options.max_frames)
        else:
            chosen = list(range(0, len(seen), options.every))
        tell(f"Of {len(observations)} frames {len(seen)} show the board; {len(chosen)} are taken.")
        seen = [seen[index] for index in chosen]
    else:
        missed = [o.name for o in observations if not o.count]
        if missed and seen:
            warnings.append(f"The board was not found in {_listed(missed)}.")
    # Where most pictures lack the board, they may show another one.
    found = detector.diagnoses
    if 2 * sum(o.count > 0 for o in observations) < len(observations):
        found = (*detector.explain(), *found)
    _check_count(seen, found)
    calibration = calibrate(detector.board, seen)
    diagnoses = worst_first(dict.fromkeys((*found, *diagnose(calibration))))
    summary = summary_of(calibration, warnings=warnings, diagnoses=diagnoses)
    files = None if options.output is None else ResultFolder(options.output, tell)
    written = write_first(files, calibration, summary)
    print_result(calibration, warnings, diagnoses=diagnoses)
    deliver(summary, written, as_json=options.json)


def _check_count(seen: Sequence[Observation], found: Sequence[Diagnosis]) -> None:
    if len(seen) < FEWEST_VIEWS and found:
        raise CalibrationError(str(found[0]))
    if 0 < len(seen) < FEWEST_VIEWS:
        picture = "picture shows" if len(seen) == 1 else "pictures show"
        raise CalibrationError(
            f"Only {len(seen)} {picture} the board, and a calibration needs at least "
            f"{FEWEST_VIEWS}, better 10 with the board tilted in different directions."
        )


def _listed(names: Sequence[str]) -> str:
    if len(names) > 5:
        return f"{', '.join(names[:4])} and {len(names) - 4} more"
    return names[0] if len(names) == 1 else f"{', '.join(names[:-1])} and {names[-1]}"
