try {
  report();
} catch (error) {
  // An old browser: the pictures without script are still there.
  document.documentElement.classList.remove("live");
  for (const id of ["live", "sky", "now"]) document.getElementById(id)?.replaceChildren();
  console.error(error);
}
