//! The receiver around the integrity core: RTCM 3, UBX and SBF in, sentences and a fail-safe pin out.
//!
//! A GNSS receiver measures ranges and forwards the navigation messages of the satellites. From
//! these bytes the module computes its own position and asks [`raim_core`] whether it may be used.
//! It reports the answer to the host in NMEA 0183, and by the level of one pin. Data pass through
//! these modules in order:
//!
//! | module | from | to |
//! |---|---|---|
//! | [`input`] | bytes of the GNSS port | raw epochs and ephemerides, each checked once |
//! | [`raw`] | | measurements common to all receivers |
//! | [`time`] | weeks and seconds of three systems | GPS time |
//! | [`ephemeris`] | broadcast elements | positions and clocks of satellites |
//! | [`correction`] | raw epoch and orbits | the core's epoch: one range of each satellite, without delays, with its sigma |
//! | [`navigator`] | raw epoch | the core's report |
//! | [`rates`] | Doppler frequencies | velocity, with its own consistency test |
//! | [`output`] | report | sentences |
//! | [`receiver`] | bytes and the time | all this in a loop, the pin, and the alert of a silent line |
//!
//! The other modules:
//!
//! | module | content |
//! |---|---|
//! | [`settings`] | commands of the host |
//! | [`bit_rate`] | bit rate of the GNSS port |
//! | [`selftest`] | known-answer tests |
//! | [`board::reset`] | cause of the last reset |
//! | [`ring`], [`timed_ring`] | bytes between an interrupt and the loop |
//! | [`outlet`] | sentences through a ring |
//! | [`counters`] | counters of unused input |
//!
//! # Wiring
//!
//! The library knows no hardware: [`receiver::Receiver`] takes an `embedded_hal` output pin, an
//! `embedded_io` writer and slices of bytes. A host runs the same code as the chip and writes the
//! same bytes. A board is a package around it. That of the STM32F405 has these ports:
//!
//! | port | pins | direction | bytes |
//! |---|---|---|---|
//! | GNSS | PA3 (USART2 RX); PA2 (TX) is connected, but nothing is sent | in | RTCM 3, UBX |
//! | host | PA9 (USART1 TX), PA10 (RX) | out and in | sentences; commands |
//! | log | PB10 (USART3 TX), RTT | out | defmt |
//! | integrity pin, its LED | PC6, PC7 | out | high while the position may be used |
//!
//! All ports start at 115200 baud, 8N1; the GNSS port then finds its rate. PC6 needs a pull-down of
//! 10 kΩ or less, because it floats from reset to start-up.
//!
//! # Features
//!
//! The default features build everything except a board. A small build reads RTCM
//! 3, and writes `RMC`, `GGA` and the module's sentences. It judges by classic RAIM with the
//! thresholds of the phases of flight. Features add the rest:
//!
//! | feature | adds |
//! |---|---|
//! | `sbf` | blocks of Septentrio receivers, beside `ubx`, which it needs for the navigation bits |
//! | `cnav` | what L2C and L5 of GPS and QZSS say of their signals: delays and health; the setting `L5` |
//! | `ubx`, `glonass`, `mavlink` | messages of u-blox receivers with their reports of jamming and spoofing, orbits of GLONASS, messages for autopilots |
//! | `araim`, `searches`, `tables`, `policies` | `METHOD,SEPARATION` and `ISM`; the methods of the papers; thresholds for all committed probabilities; `POLICY,T2` and `TOP` |
//! | `past` | alerts `CLOCK`, `TRACK` and the verdict `SIGMAS`; the velocity |
//! | `hypotheses` | alert `TIME`; detection and exclusion of a system that is shifted or broken as a whole |
//! | `aiding` | `CLOCKAID`, `NOISE,AUTO` at rest, `PLACE`, `HEIGHTAID` |
//! | `signs` | detection of two receivers that take turns, copied ranges, bands that disagree, strengths that are alike |
//! | `sentences` | `GNS`, `VTG`, `ZDA`, `GSA`, `GST`, `GBS` |
//! | `osnma` | `KEY`, `ROOT`, `AUTH`, `TRUST`: authenticated ephemerides of Galileo; proved Galileo decides where systems contradict each other (`SYSTEM`); distance between the places of single systems |
//! | `both-kinds` | what residuals of one frequency and of two say of their noise, also for the kind that is not in use |
//! | `gsv` | `GSV` |
//! | `satellites-32`, `satellites-48` | room for as many satellites in an epoch, instead of 16 |
//! | `log`, `defmt` | the log of a board, and its formats; `defmt` is off at start |
//! | `observer` | an account of each judged epoch, satellite by satellite, for a program on a computer ([`observer`]); off at start |
//!
//! Commands that need a missing feature are refused with `not in this build`. Boards are
//! packages of their own, which bring the crates of their chips.
//!
//! # Output
//!
//! The receiver writes to any [`embedded_io::Write`]: a ring to an interrupt ([`outlet`]), the
//! driver of a port, or a `&mut [u8]`. On a host it can be a `Vec<u8>`, for which the caller
//! enables the feature `alloc` (or `std`) of `embedded-io`. The receiver writes complete sentences,
//! and calls `write` until all bytes are taken.
//!
//! # Stability
//!
//! Reasons, settings, events, errors and refusals are `#[non_exhaustive]`, as in [`raim_core`]: a
//! minor version may add one, and a `match` on them needs an arm `_`. This holds for a program that
//! uses both libraries, too:
//!
//! ```
//! # use raim_core::report::Alert;
//! # use raim_firmware::settings::Phase;
//! fn is_of_the_receiver(alert: Alert, phase: Phase) -> bool {
//!     match alert {
//!         Alert::Spoofed => phase != Phase::EnRoute,
//!         Alert::Fault | Alert::Ambiguous | Alert::Time | Alert::Stale | Alert::Jump => false,
//!         Alert::Clock | Alert::Track | Alert::Source => false,
//!         _ => false, // without this arm it does not compile
//!     }
//! }
//! ```
//!
//! # What this crate does not do
//!
//! It does not track signals, smooth with carrier phase, use SBAS or corrections of a network, or
//! keep data over a power cycle. GLONASS and QZSS are used if `SYSTEMS` names them. The leap
//! seconds between GPS time and UTC are those of the image ([`output::nmea::GPS_MINUS_UTC_S`])
//! until a receiver or a satellite sends them.
//!
//! # References
//!
//! | tag | source |
//! |---|---|
//! | `AN500` | Arm DAI 0500, *Application Note AN500*, for the MPS2 board |
//! | `ARMv7-M` | Arm DDI 0403, *ARMv7-M Architecture Reference Manual* |
//! | `BDS-SIS-B1I` | China Satellite Navigation Office, *`BeiDou` navigation satellite system signal in space interface control document, open service signal B1I*, version 3.0, 2019 |
//! | `BDS-SIS-B3I` | China Satellite Navigation Office, *`BeiDou` navigation satellite system signal in space interface control document, open service signal B3I*, version 1.0, 2018 |
//! | `BDS-SIS-ICD` | these two documents, where they agree |
//! | `Blanch2015` | see the crate [`raim_core`] |
//! | `CMSDK` | Arm DDI 0479, *Cortex-M System Design Kit technical reference manual* |
//! | `DO-229` | RTCA DO-229, *Minimum operational performance standards for global positioning system/wide area augmentation system airborne equipment* |
//! | `DO-260B` | RTCA DO-260B, *Minimum operational performance standards for 1090 MHz extended squitter ADS-B and TIS-B* |
//! | `DS8626` | STMicroelectronics, DS8626, *STM32F405xx, STM32F407xx*, data sheet |
//! | `EGM96` | F. G. Lemoine et al., *The development of the joint NASA GSFC and NIMA geopotential model EGM96*, NASA/TP-1998-206861, 1998; grid `WW15MGH.DAC` of the US National Geospatial-Intelligence Agency |
//! | `GLO-ICD` | Russian Institute of Space Device Engineering, *GLONASS Interface Control Document, navigational radio signal in bands L1, L2*, edition 5.1, 2008 |
//! | `GPSD-NMEA` | E. S. Raymond, *NMEA Revealed*, gpsd project, <https://gpsd.gitlab.io/gpsd/NMEA.html> |
//! | `GPS-SPS-PS` | US Department of Defense, *Global Positioning System standard positioning service performance standard*, 5th edition, 2020 |
//! | `ICAO-9871` | ICAO Doc 9871, *Technical provisions for Mode S services and extended squitter* |
//! | `ICAO-A10` | ICAO, Annex 10 to the Convention on International Civil Aviation, *Aeronautical telecommunications*, Volume I, *Radio navigation aids*, table 3.7.2.4-1 |
//! | `IS-GPS-200` | *NAVSTAR GPS space segment/navigation user segment interfaces*, interface specification of the US Space Force |
//! | `IS-GPS-705` | *NAVSTAR GPS space segment/user segment L5 interfaces*, interface specification of the US Space Force |
//! | `IS-QZSS-PNT` | Cabinet Office of Japan, *Quasi-Zenith Satellite System interface specification, satellite positioning, navigation and timing service* |
//! | `ITU-R TF.460-6` | ITU-R Recommendation TF.460-6, *Standard-frequency and time-signal emissions*, 2002 |
//! | `Klobuchar1987` | J. A. Klobuchar, *Ionospheric time-delay algorithm for single-frequency GPS users*, IEEE Trans. AES 23(3) (1987) 325–331 |
//! | `Knuth1997` | D. E. Knuth, *The Art of Computer Programming*, volume 2, *Seminumerical Algorithms*, 3rd edition, Addison-Wesley, 1997 |
//! | `MAVLINK` | `MAVLink` developer guide, *Serialization*, <https://mavlink.io/en/guide/serialization.html>, and the message definitions `common.xml` and `development.xml` |
//! | `NMEA-0183` | National Marine Electronics Association, *NMEA 0183, standard for interfacing marine electronic devices*, version 4.11, 2018 |
//! | `OS-SDD` | European Union, *Galileo open service, service definition document*, version 1.3, 2023 |
//! | `OS-SIS-ICD` | European Union, *European GNSS (Galileo) open service signal-in-space interface control document* |
//! | `FIPS-180-4` | NIST FIPS 180-4, *Secure hash standard*, 2015 |
//! | `FIPS-186-5` | NIST FIPS 186-5, *Digital signature standard*, 2023 |
//! | `OSNMA-ICD` | European Union, *Galileo open service navigation message authentication (OSNMA) signal-in-space interface control document*, issue 1.1, 2023 |
//! | `OSNMA-RG` | European Union, *Galileo OSNMA receiver guidelines*, issue 1.3, 2024 |
//! | `RM0090` | STMicroelectronics, RM0090, *STM32F405/415, STM32F407/417, STM32F427/437 and STM32F429/439 advanced Arm-based 32-bit MCUs*, reference manual |
//! | `Renes2016` | J. Renes, C. Costello and L. Batina, *Complete addition formulas for prime order elliptic curves*, EUROCRYPT 2016 |
//! | `RTCM-10403.3` | RTCM Special Committee 104, RTCM 10403.3, *Differential GNSS (Global Navigation Satellite Systems) services, version 3*, 2016, with amendments |
//! | `SBF` | Septentrio, *mosaic-X5 reference guide, applicable to version 4.14 of the firmware*, 2023, chapter 4, *SBF reference* |
//! | `Saastamoinen1972` | J. Saastamoinen, *Atmospheric correction for the troposphere and stratosphere in radio ranging of satellites*, in *The use of artificial satellites for geodesy*, AGU Geophysical Monograph 15 (1972) 247–251 |
//! | `UBX-F9` | u-blox UBX-22008968, *u-blox F9 HPG 1.32 interface description* |
//! | `UBX-M8` | u-blox UBX-13003221, *u-blox 8/u-blox M8 receiver description including protocol specification* |
//! | `Yang2015` | Yang Lin et al., RAIM threshold optimisation, Electronics Optics & Control 22(7) (2015) 38–42 |
#![no_std]
#![forbid(unsafe_code)]
#![warn(clippy::missing_panics_doc)]
// A small build leaves shared parts unused, and marking each part with its features would be noise.
#![cfg_attr(not(feature = "whole"), allow(dead_code))]

#[cfg(test)]
extern crate std;

pub mod bit_rate;
pub mod board;
#[doc(hidden)]
pub mod correction;
pub mod counters;
#[doc(hidden)]
pub mod division;
#[doc(hidden)]
pub mod ephemeris;
pub mod epoch_loop;
pub mod input;
mod known_place;
mod median;
#[doc(hidden)]
pub mod navigator;
pub mod observer;
#[cfg(feature = "osnma")]
#[doc(hidden)]
pub mod osnma;
pub mod outlet;
#[doc(hidden)]
pub mod output;
pub mod pin;
#[doc(hidden)]
pub mod publisher;
#[doc(hidden)]
pub mod rates;
#[doc(hidden)]
pub mod raw;
pub mod receiver;
pub mod ring;
#[doc(hidden)]
pub mod selftest;
pub mod settings;
#[doc(hidden)]
pub mod time;
pub mod timed_ring;

/// The example of the readme.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;

/// The example under *Stability* without its last arm, which is all that can fail to compile.
///
/// ```compile_fail,E0004
/// # use raim_core::report::Alert;
/// # use raim_firmware::settings::Phase;
/// fn is_of_the_receiver(alert: Alert, phase: Phase) -> bool {
///     match alert {
///         Alert::Spoofed => phase != Phase::EnRoute,
///         Alert::Fault | Alert::Ambiguous | Alert::Time | Alert::Stale | Alert::Jump => false,
///         Alert::Clock | Alert::Track | Alert::Source => false,
///     }
/// }
/// ```
#[cfg(doctest)]
struct MatchWithoutLastArm;
