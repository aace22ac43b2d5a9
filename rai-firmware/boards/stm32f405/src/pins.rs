//! The integrity pin, its LED, and the pins of the ports.
//!
//! The pin is high only while the position of the last epoch may be used. The chip leaves it
//! floating between reset and start-up, so that the circuit needs a pull-down of 10 kΩ or less. The
//! pull-down also keeps the line low while the chip has no power.
//!
//! References: [DS8626] table 9 (alternate functions).
//!
//! [DS8626]: raim_firmware#references

use core::convert::Infallible;

use embedded_hal::digital::{ErrorType, OutputPin};
use stm32f4::stm32f405::{GPIOA, GPIOB, GPIOC, RCC};

/// Output of the integrity pin: PC6, and PC7 for an LED.
pub struct PinAndLed(GPIOC);

impl PinAndLed {
    /// Drives the pin low. The level is written before the pin becomes an output, so that it has no
    /// high glitch.
    pub fn take(rcc: &RCC, port: GPIOC) -> Self {
        rcc.ahb1enr().modify(|_, w| w.gpiocen().enabled());
        port.bsrr().write(|w| w.br6().set_bit().br7().set_bit());
        port.moder().modify(|_, w| w.moder6().output().moder7().output());
        Self(port)
    }
}

impl ErrorType for PinAndLed {
    type Error = Infallible;
}

impl OutputPin for PinAndLed {
    fn set_low(&mut self) -> Result<(), Infallible> {
        self.0.bsrr().write(|w| w.br6().set_bit().br7().set_bit());
        Ok(())
    }

    fn set_high(&mut self) -> Result<(), Infallible> {
        self.0.bsrr().write(|w| w.bs6().set_bit().bs7().set_bit());
        Ok(())
    }
}

/// Drives the pin low from a fault handler, whatever owns it.
#[allow(unsafe_code)]
pub fn drop_integrity_pin() {
    // SAFETY: the register sets and resets single pins by writing, so that it needs no exclusive
    // access; the owner of the port never runs again.
    let port = unsafe { GPIOC::steal() };
    port.bsrr().write(|w| w.br6().set_bit().br7().set_bit());
}

/// Gives the pins of the three ports to their USARTs.
pub fn route_ports(rcc: &RCC, a: &GPIOA, b: &GPIOB) {
    rcc.ahb1enr().modify(|_, w| w.gpioaen().enabled().gpioben().enabled());
    a.afrl().modify(|_, w| w.afrl2().af7().afrl3().af7());
    a.afrh().modify(|_, w| w.afrh9().af7().afrh10().af7());
    b.afrh().modify(|_, w| w.afrh10().af7());
    // A receiver input without a cable must rest at the idle level and not collect noise.
    a.pupdr().modify(|_, w| w.pupdr3().pull_up().pupdr10().pull_up());
    a.moder().modify(|_, w| {
        w.moder2().alternate().moder3().alternate().moder9().alternate().moder10().alternate()
    });
    b.moder().modify(|_, w| w.moder10().alternate());
}
