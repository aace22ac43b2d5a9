"""Starts an image on a simulated STM32F405, and prints its clock, port and watchdog registers.

Arguments: the image; the time until the registers are read without a crystal. With a crystal they
are read after 0.8 ms.
"""

import json
import re
import sys
import tempfile
from pathlib import Path

import labwired

REGISTERS = {
    "rcc_cr": 0x4002_3800,
    "rcc_cfgr": 0x4002_3808,
    "flash_acr": 0x4002_3C00,
    "usart1_brr": 0x4001_1008,
    "usart2_brr": 0x4000_4408,
    "usart3_brr": 0x4000_4808,
    "iwdg_pr": 0x4000_3004,
    "iwdg_rlr": 0x4000_3008,
}


def with_third_port(chip):
    """Adds USART3, which the packaged description lacks, as a copy of USART2."""
    second = re.search(r'  - id: "uart2".*?(?=  - id:)', chip, re.S).group()
    third = second.replace("uart2", "uart3").replace("0x40004400", "0x40004800").replace("irq: 38", "irq: 39")
    return chip.replace(second, second + third, 1)


def without_crystal(chip):
    """Makes the clock controller plain memory, so that the crystal never reports ready."""
    chip = re.sub(r"\n *clock: *\{[^}]*\}", "", chip)
    chip = re.sub(r"\n    clock:\n(      .*\n)+", "\n", chip)
    controller = re.search(r'  - id: "rcc".*?(?=  - id:)', chip, re.S).group()
    plain = (
        '  - id: "rcc"\n    type: "declarative"\n    base_address: 0x40023800\n    size: "1KB"\n'
        '    config:\n      path: "../peripherals/stm32f405/rcc.yaml"\n'
    )
    return chip.replace(controller, plain, 1)


def registers(image, chip, after):
    configs = Path(labwired.__file__).parent / "configs"
    with tempfile.TemporaryDirectory() as folder:
        folder = Path(folder)
        (folder / "chips").mkdir()
        (folder / "peripherals").symlink_to(configs / "peripherals")
        (folder / "chips/chip.yaml").write_text(chip)
        (folder / "board.yaml").write_text('name: "board"\nchip: "chips/chip.yaml"\n')
        with labwired.Sim(image, system=folder / "board.yaml", uart="uart1") as board:
            board.run_for(after)
            return {name: board.read_u32(address) for name, address in REGISTERS.items()}


image = sys.argv[1]
packaged = (Path(labwired.__file__).parent / "configs/chips/stm32f405.yaml").read_text()
chip = with_third_port(packaged)
print(json.dumps({
    "crystal": registers(image, chip, "800us"),
    "none": registers(image, without_crystal(chip), sys.argv[2]),
}))
