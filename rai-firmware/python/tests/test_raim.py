"""The package on arrays and on a recording: `RAIM_CAPTURE` names the recording, `RAIM_EPOCHS` the number of its epochs."""

import math
import os
import unittest

import numpy as np

import raim

# The first example of the README of RAI: seven satellites 22,000 km from Esbjerg, of which G05 is wrong by 80 m.
POSITIONS_M = np.array(
    [
        [15909567.8, 2365446.2, 23362131.7],
        [-3367221.5, -500641.0, 26080759.6],
        [25324386.9, 3765248.4, 6140002.4],
        [8390254.2, 19040938.2, 16110381.0],
        [13566911.3, -15776330.8, 16110381.0],
        [922952.3, 13482327.0, 22817783.2],
        [1054936.5, -10519232.7, 24086683.9],
    ]
)
FAULTY_M = np.array([22e6, 22e6, 22e6, 22e6, 22e6 + 80.0, 22e6, 22e6])
GOOD_M = np.full(7, 22e6)


class Judge(unittest.TestCase):
    def test_satellite_that_is_wrong_is_left_out(self):
        verdict = raim.judge(FAULTY_M, POSITIONS_M, 2.0)
        self.assertEqual((verdict.state[0], verdict.reason[0]), ("protected", "EXCLUDED"))
        np.testing.assert_array_equal(verdict.is_used[0], np.arange(7) != 4)
        # The satellites' positions are rounded to a decimetre.
        np.testing.assert_allclose(verdict.residual_m[0], FAULTY_M - 22e6, atol=0.5)
        np.testing.assert_allclose(verdict.position_m[0], [3582105.0, 532590.0, 5232755.0], atol=25.0)
        self.assertTrue(verdict.is_protected[0])

    def test_whole_day_is_judged_epoch_by_epoch(self):
        ranges = np.tile(GOOD_M, (86_400 // 60, 1))
        ranges[700] = FAULTY_M
        ranges[800, 3:] = np.nan
        verdict = raim.judge(ranges, POSITIONS_M, np.full(7, 2.0), times_s=np.arange(len(ranges)) * 60.0)
        self.assertEqual(verdict.hpl_m.shape, (1440,))
        self.assertEqual((verdict.reason[699], verdict.reason[700], verdict.reason[800]), ("OK", "EXCLUDED", "NOFIX"))
        self.assertTrue(np.isnan(verdict.position_m[800]).all() and np.isnan(verdict.hpl_m[800]))
        self.assertTrue(np.isnan(verdict.residual_m[800]).all() and not verdict.is_used[800].any())
        self.assertEqual((verdict.state == "protected").sum(), 1439)
        self.assertEqual(verdict.covariance_m2.shape, (1440, 6))

    def test_levels_are_numbers(self):
        # Four satellites leave nothing to test with, five exclude nothing.
        for count in (4, 5, 7):
            verdict = raim.judge(GOOD_M[:count], POSITIONS_M[:count], 2.0)
            self.assertEqual(verdict.hpl_m.dtype, np.float64)
            self.assertIsInstance(float(verdict.hpl_m[0]), float)

    def test_araim_bounds_more_than_a_single_fault(self):
        classic = raim.judge(GOOD_M, POSITIONS_M, 2.0, phase="LPV200")
        advanced = raim.araim(GOOD_M, POSITIONS_M, 2.0)
        self.assertTrue(np.isfinite(advanced.vpl_m).all())
        self.assertEqual(advanced.reason[0], "VPL")
        self.assertNotEqual(advanced.vpl_m[0], classic.vpl_m[0])

    def test_wrong_arguments_are_named(self):
        for wrong, error, words in [
            ({"phase": "LANDING"}, ValueError, "ENROUTE"),
            ({"hal_m": -1.0}, raim.RefusedError, "horizontal alert limit"),
            ({"hal": 40.0}, TypeError, "hal_m"),
            ({"satellites": ["G01"]}, ValueError, "7 columns"),
            ({"satellites": ["G1", "G2", "G3", "G4", "G5", "G6", "X7"]}, ValueError, "'X7'"),
        ]:
            with self.subTest(wrong), self.assertRaisesRegex(error, words):
                raim.judge(GOOD_M, POSITIONS_M, 2.0, **wrong)
        with self.assertRaises(ValueError):
            raim.judge(GOOD_M, POSITIONS_M[:6], 2.0)

    def test_satellites_have_the_clock_of_their_system(self):
        ranges = GOOD_M.copy()
        ranges[3:] += 100.0
        names = ["G01", "G02", "G03", "E04", "E05", "E06", "E07"]
        self.assertEqual(raim.judge(ranges, POSITIONS_M, 2.0, satellites=names).reason[0], "OK")


@unittest.skipUnless(os.environ.get("RAIM_CAPTURE"), "needs a recording")
class Recording(unittest.TestCase):
    def test_recording_gives_the_epochs_of_the_module(self):
        run = raim.replay(os.environ["RAIM_CAPTURE"])
        wanted = int(os.environ["RAIM_EPOCHS"])
        self.assertEqual(len(run.epochs), wanted)
        protected = run.epochs[run.epochs.state == "protected"]
        self.assertGreaterEqual(len(protected), 10)
        self.assertTrue(protected.pin.all() and np.isfinite(protected.hpl_m).all())
        self.assertEqual(run.counters["epochs_protected"], len(protected))
        # Nothing is lost between pieces, and no pause cuts a frame.
        self.assertEqual((run.counters["frames_cut"], run.counters["crc_failures"]), (0, 0))
        used = run.satellites[run.satellites.is_used].groupby("epoch").size()
        self.assertEqual(used.to_dict(), {k: v for k, v in run.epochs.used.to_dict().items() if v})
        rms_m = run.satellites[run.satellites.is_used].groupby("epoch").residual_m.apply(lambda r: math.sqrt((r**2).mean()))
        np.testing.assert_allclose(rms_m, run.epochs.residual_rms_m[rms_m.index], rtol=1e-3, atol=1e-3)
        for column in ("time_s", "hpl_m", "vpl_m", "statistic", "height_m", "east_m_s"):
            self.assertEqual(run.epochs[column].dtype, np.float64, column)

    @unittest.skipUnless(os.environ.get("RAIM_SATELLITES"), "needs the table of `rai replay --satellites`")
    def test_satellites_are_those_of_the_command(self):
        import pandas as pd

        have = raim.replay(os.environ["RAIM_CAPTURE"], {"MASK": "25"}).satellites
        want = pd.read_csv(os.environ["RAIM_SATELLITES"])
        self.assertEqual(len(have), len(want))
        for ours, theirs in (("satellite", "satellite"), ("reason", "reason"), ("is_used", "used")):
            self.assertEqual(list(have[ours]), list(want[theirs].astype(have[ours].dtype)), ours)
        # The table has rounded numbers.
        for column, atol in [("azimuth_deg", 0.0051), ("elevation_deg", 0.0051), ("cn0_dbhz", 0.0051)] + [
            (column, 0.00051) for column in ("residual_m", "sigma_m", "w_test")
        ]:
            np.testing.assert_allclose(have[column], want[column], rtol=0, atol=atol, err_msg=column)
        self.assertGreater(len(set(have.reason)), 1)
        self.assertTrue(have[have.is_used].notna().all(axis=None))

    @unittest.skipUnless(os.environ.get("RAIM_SIGNED"), "needs the recording of a signed sky")
    def test_ephemerides_are_proved_or_false(self):
        # Eight satellites, of which one sends a false orbit.
        epochs = raim.replay(os.environ["RAIM_SIGNED"], {"KEY": os.environ["RAIM_KEY"]}).epochs
        last = epochs.iloc[-1]
        self.assertEqual((last.osnma_state, last.osnma_proved, last.osnma_unproved, last.osnma_false), ("UNDATED", 7, 0, 1))
        self.assertTrue(0 < last.osnma_oldest_proof_s < 120)
        self.assertTrue(np.isnan(epochs.osnma_oldest_proof_s[30]) and epochs.osnma_state[30] == "WAIT")
        without = raim.replay(os.environ["RAIM_CAPTURE"]).epochs
        self.assertTrue((without.osnma_state == "").all() and (without.osnma_proved == 0).all())

    def test_setting_is_obeyed_or_refused(self):
        run = raim.replay(os.environ["RAIM_CAPTURE"], {"PHASE": "LPV200"})
        self.assertTrue(any(line.startswith("$PRAIA,PHASE,LPV200,OK") for line in run.sentences))
        with self.assertRaisesRegex(raim.RefusedError, "unknown value"):
            raim.replay(os.environ["RAIM_CAPTURE"], {"PHASE": "LANDING"})


if __name__ == "__main__":
    unittest.main()
