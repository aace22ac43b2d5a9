// The events of the service, which is the only one that the page asks.
const serve = () => {
  const SILENT_MS = 3500;
  const { begin, take, lost } = live();
  let heard = 0;
  const source = new EventSource("events");
  source.addEventListener("past", (event) => begin(JSON.parse(event.data)));
  source.addEventListener("state", (event) => {
    heard = Date.now();
    take(JSON.parse(event.data));
  });
  source.addEventListener("error", lost);
  setInterval(() => {
    if (heard && Date.now() - heard > SILENT_MS) lost();
  }, 250);
};
serve();
