//! Accuracy indices of the messages, converted to metres.

/// Returns the standard deviation of a URA index of GPS or `BeiDou`, m; `None` for 15 and above,
/// which mean that no accuracy is promised.
///
/// The nominal values of [IS-GPS-200] 20.3.3.3.1.3 and of the URAI of [BDS-SIS-B1I] 5.2.4.5 are the
/// same. Below index 6 they are `2^(1+N/2)`, with 2.8, 5.7 and 11.3 for the odd indices. From 6 on
/// they are `2^(N−2)`.
///
/// [IS-GPS-200]: crate#references
/// [BDS-SIS-B1I]: crate#references
pub fn ura_m(index: u8) -> Option<f32> {
    const URA_M: [f32; 15] =
        [2.0, 2.8, 4.0, 5.7, 8.0, 11.3, 16.0, 32.0, 64.0, 128.0, 256.0, 512.0, 1024.0, 2048.0, 4096.0];
    URA_M.get(usize::from(index)).copied()
}

/// Returns the standard deviation of the index `F_T` of GLONASS, m; `None` for 15, which means that
/// no accuracy is promised.
///
/// See [GLO-ICD] table 4.4.
///
/// [GLO-ICD]: crate#references
pub fn glonass_accuracy_m(index: u8) -> Option<f32> {
    const F_T_M: [f32; 15] =
        [1.0, 2.0, 2.5, 4.0, 5.0, 7.0, 10.0, 12.0, 14.0, 16.0, 32.0, 64.0, 128.0, 256.0, 512.0];
    F_T_M.get(usize::from(index)).copied()
}

/// Returns the standard deviation of a SISA index of Galileo, m, or `None` for the spare values and
/// for "no accuracy prediction".
///
/// The values form four linear pieces, [OS-SIS-ICD] 5.1.12, "SISA index values": table 76 in
/// version 1.3, table 89 in version 2.1.
///
/// [OS-SIS-ICD]: crate#references
pub fn galileo_sisa_m(index: u8) -> Option<f32> {
    let above = |start: u8| f32::from(index - start);
    match index {
        0..=49 => Some(0.01 * above(0)),
        50..=74 => Some(0.5 + 0.02 * above(50)),
        75..=99 => Some(1.0 + 0.04 * above(75)),
        100..=125 => Some(2.0 + 0.16 * above(100)),
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn galileo_index_107_is_the_usual_3_12_metres() {
        // Index and metres as in receivers' RINEX files: 107 is 3.12 m.
        assert!((galileo_sisa_m(107).unwrap() - 3.12).abs() < 1e-6);
    }

    #[test]
    fn accuracies_of_gps_and_beidou_follow_the_rule_of_their_documents() {
        for index in 0..15_u8 {
            let n = f32::from(index);
            let rule = if index < 6 { libm::exp2f(1.0 + n / 2.0) } else { libm::exp2f(n - 2.0) };
            let have = ura_m(index).unwrap();
            // 2.828, 5.657 and 11.314 are printed with one digit.
            assert!((have - rule).abs() < 0.05, "{index}: have {have}, want {rule}");
        }
    }

    #[test]
    fn an_index_without_promise_has_no_metres() {
        assert_eq!(ura_m(15), None);
        assert_eq!(galileo_sisa_m(255), None);
        assert_eq!(galileo_sisa_m(126), None);
    }
}
