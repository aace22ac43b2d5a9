// Time since the start, ms, which no step of the date moves back. While a computer sleeps the clock of a page may stand
// still: what the date has gone ahead by more than a second is added, so that a verdict of before is old when it wakes.
const monotonic = () => {
  const begun = performance.now(), date = Date.now();
  let slept = 0;
  return () => {
    const passed = performance.now() - begun, ahead = Date.now() - date - passed;
    if (ahead > slept + 1000) slept = ahead;
    return passed + slept;
  };
};
