"""The guidance loop: newest frame in, snapshot out. `run_guide` is the way in."""

from venus3d.app.guide import GuideResult, run_guide, run_guided_trial

__all__ = ["GuideResult", "run_guide", "run_guided_trial"]
