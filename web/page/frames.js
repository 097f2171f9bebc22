// Pages of studies, each in a frame.

/** Said where a host keeps the page from its frames or its scripts. */
const ALONE = "open archrock.html alone, or install the program";

/** Shows pages in a holder, one at a time. */
function createFrames(holder, title) {
  let frame = null;
  let observer = null;
  return {
    inside: () => frame?.contentWindow,
    clear() {
      observer?.disconnect();
      frame?.remove();
      frame = null;
    },
    /** Shows a page; fails where the host refuses frames. */
    show(html) {
      const next = document.createElement("iframe");
      Object.assign(next, { className: "waiting", title, scrolling: "no", srcdoc: html });
      holder.querySelectorAll(".waiting").forEach((other) => other.remove());
      holder.append(next);
      return new Promise((resolve, reject) => {
        next.onload = async () => {
          const root = next.contentDocument?.documentElement;
          if (!root) return reject(new Error(`This host refuses frames, in which studies are shown: ${ALONE}.`));
          const fit = () => (next.style.height = `${Math.ceil(root.getBoundingClientRect().height) + 2}px`);
          root.style.overflow = "hidden";
          // A table that scrolls can be scrolled by keys.
          for (const table of root.querySelectorAll(".scroll")) Object.assign(table, { tabIndex: 0, role: "region", ariaLabel: "Table" });
          takeDrops(next.contentDocument);
          takeUndo(next.contentDocument);
          next.classList.remove("waiting");
          observer?.disconnect();
          frame?.remove();
          frame = next;
          observer = new ResizeObserver(fit);
          observer.observe(root);
          await next.contentWindow.archrock?.ready;
          resolve();
        };
      });
    },
  };
}
