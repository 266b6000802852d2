"""What a master may do wrong with instances, and around failures."""

from pathlib import Path
from typing import Any

from fmpy.fmi2 import fmi2CallbackLoggerTYPE

from tests.fmu.inside.probing import alive, made, probe
from tests.fmu.inside.raw import Raw


def _instantiating(call: str, title: str, **changed: Any) -> None:
    def instantiated(raw: Raw) -> Any:
        instance = made(raw, **changed)
        return bool(instance) and alive(raw, instance)

    instantiated.__name__ = call
    probe(title)(instantiated)


_instantiating("wrong_guid", "The GUID is another one", guid=b"x")
_instantiating("null_guid", "The GUID is NULL", guid=None)
_instantiating("model_exchange", "A model-exchange instance is asked for", kind=0)
_instantiating("null_name", "The instance name is NULL", name=None)
_instantiating("empty_name", "The instance name is empty", name=b"")
_instantiating("long_name", "The instance name has a million characters", name=b"x" * 10**6)
_instantiating(
    "name_with_formats", "The instance name holds `%s%n`, logging on", name=b"%s%n%d%%", logging=1
)
_instantiating(
    "name_in_utf8", "The instance name is not ASCII, but UTF-8", name="Größe 摩擦 🧱".encode()
)
_instantiating("name_not_utf8", "The instance name is not UTF-8", name=b"\xff\xfe")
_instantiating("null_resources", "The folder of resources is NULL", resources=None)
_instantiating(
    "no_such_folder", "The folder of resources is not there", resources=b"file:///nowhere/resources"
)
_instantiating("null_callbacks", "The callbacks are NULL, logging off", callbacks=None)
_instantiating(
    "null_callbacks_with_logging", "The callbacks are NULL, logging on", callbacks=None, logging=1
)


@probe("The folder of resources is a path, not a URI")
def _folder_without_scheme(raw: Raw) -> Any:
    return alive(raw, made(raw, resources=raw.resources.removeprefix(b"file://")))


@probe("The folder of resources ends in a slash")
def _folder_with_end_slash(raw: Raw) -> Any:
    return alive(raw, made(raw, resources=raw.resources + b"/"))


@probe("The folder of resources is `file:/...`, with one slash")
def _folder_with_one_slash(raw: Raw) -> Any:
    return bool(made(raw, resources=raw.resources.replace(b"file://", b"file:")))


@probe("The folder of resources is `file://localhost/...`")
def _folder_with_host(raw: Raw) -> Any:
    return bool(made(raw, resources=raw.resources.replace(b"file://", b"file://localhost")))


@probe("The URI of the folder has an escape other than `%20`, as for `ü` or `#`")
def _folder_with_escape(raw: Raw) -> Any:
    return bool(made(raw, resources=raw.resources[:-1] + b"%73"))


@probe("The URI of the folder has `%20` for a blank")
def _folder_with_blank(raw: Raw) -> Any:
    folder = Path(raw.resources.decode().removeprefix("file://"))
    link = folder.with_name("with a blank")
    link.symlink_to(folder)
    return alive(raw, made(raw, resources=link.as_uri().encode()))


@probe("Logging is on and the logger is NULL")
def _null_logger_with_logging(raw: Raw) -> Any:
    raw.callbacks.logger = fmi2CallbackLoggerTYPE()
    return alive(raw, made(raw, logging=1))


@probe("NULL is freed")
def _free_null_instance(raw: Raw) -> Any:
    return raw.FreeInstance(None)


@probe("An instance is freed twice")
def _free_instance_twice(raw: Raw) -> Any:
    instance = raw.started()
    raw.FreeInstance(instance)
    raw.FreeInstance(instance)
    return None


@probe("A call goes to NULL")
def _step_null_instance(raw: Raw) -> Any:
    return raw.DoStep(None, 0.0, 0.1, 0)


@probe("A call goes to an instance that is freed")
def _step_freed_instance(raw: Raw) -> Any:
    instance = raw.started()
    raw.FreeInstance(instance)
    return raw.DoStep(instance, 0.0, 0.1, 0)


@probe("One failure follows another, a thousand times")
def _two_failures(raw: Raw) -> Any:
    instance = raw.started()
    seen = [raw.DoStep(instance, 0.0, -1.0, 0) for _ in range(1000)]
    return [min(seen), max(seen), alive(raw, instance)]


@probe("An instance is freed after a failure")
def _failure_then_free(raw: Raw) -> Any:
    instance = raw.started()
    seen = raw.DoStep(instance, 0.0, -1.0, 0)
    raw.FreeInstance(instance)
    return seen


@probe("An instance is freed before anything was called, logging on")
def _free_without_set_up(raw: Raw) -> Any:
    for _ in range(100):
        raw.FreeInstance(raw.instance(logging=True))
    return None
