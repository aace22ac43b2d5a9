"""The library for C in a PlatformIO project: builds it with cargo for the processor of the board.

    [env:board]
    lib_deps = symlink:///path/to/rai/rai-firmware/capi
    custom_rai_features = receiver,ubx       ; default: whole

Needs rustup with the target, whose name the error prints if it is missing. An option `custom_rai_target` names the
target of a processor that is not in the table.
"""

import os
import subprocess

# Processor in the flags of the board, and target without and with -mfloat-abi=hard.
TARGETS = {
    "cortex-m0": ("thumbv6m-none-eabi", None),
    "cortex-m0plus": ("thumbv6m-none-eabi", None),
    "cortex-m3": ("thumbv7m-none-eabi", None),
    "cortex-m4": ("thumbv7em-none-eabi", "thumbv7em-none-eabihf"),
    "cortex-m7": ("thumbv7em-none-eabi", "thumbv7em-none-eabihf"),
    "cortex-m23": ("thumbv8m.base-none-eabi", None),
    "cortex-m33": ("thumbv8m.main-none-eabi", "thumbv8m.main-none-eabihf"),
}


def target_of(flags, cpu):
    """Returns the Rust target of a processor, from the flags of the C compiler or the name of the board's processor."""
    named = [str(flag)[len("-mcpu="):] for flag in flags if str(flag).startswith("-mcpu=")]
    cpu = named[0] if named else cpu
    soft, hard = TARGETS.get(cpu, (None, None))
    target = hard if "-mfloat-abi=hard" in [str(flag) for flag in flags] else soft
    if target is None:
        raise SystemExit(f"rai: no Rust target is known for the processor {cpu!r}: set custom_rai_target")
    return target


def build(env):
    """Builds the library and adds it to the program."""
    here = env.Dir(".").srcnode().abspath
    flags = list(env.get("CCFLAGS", [])) + list(env.get("LINKFLAGS", []))
    target = env.GetProjectOption("custom_rai_target", "") or target_of(flags, env.BoardConfig().get("build.cpu", ""))
    features = env.GetProjectOption("custom_rai_features", "whole")
    out = os.path.join(env.subst("$BUILD_DIR"), "rai")
    command = ["cargo", "rustc", "--package", "rai-capi", "--lib", "--crate-type", "staticlib"]
    command += ["--profile", "firmware", "--no-default-features", "--features", features + ",satellites-48,panic-handler"]
    command += ["--target", target, "--target-dir", out]
    subprocess.run(command, cwd=here, check=True)
    from SCons.Script import DefaultEnvironment  # only exists within PlatformIO

    program = DefaultEnvironment()
    program.Append(LIBPATH=[os.path.join(out, target, "firmware")], LIBS=["rai"], CPPPATH=[os.path.join(here, "include")])


if "Import" in globals():
    Import("env")  # noqa: F821, PlatformIO defines both
    build(env)  # noqa: F821
