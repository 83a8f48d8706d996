// A browser starts no worker for a page that is opened as a file: there the search runs in a hidden frame.
if (location.protocol === "file:") {
  window.Worker = class extends EventTarget {
    constructor(url) {
      super();
      const frame = document.createElement("iframe");
      frame.hidden = true;
      document.body.append(frame);
      this.inside = frame.contentWindow;
      const page = frame.contentDocument;
      page.open();
      page.write(`<body><script>postMessage = (data) => parent.postMessage(data, "*")</script>`);
      page.write(`<script src="${url}"></script></body>`);
      page.close();
      this.ready = new Promise((loaded) => { this.inside.addEventListener("load", loaded); }); // open() drops listeners
      addEventListener("message", ({ source, data }) => {
        if (source === this.inside) this.dispatchEvent(new MessageEvent("message", { data }));
      });
    }

    postMessage(data) {
      this.ready.then(() => this.inside.dispatchEvent(new MessageEvent("message", { data })));
    }
  };
}
