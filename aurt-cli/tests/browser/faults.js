(() => {
  const faults = [];
  const page = document.documentElement;
  if (page.scrollWidth > page.clientWidth) faults.push(`the page is ${page.scrollWidth} wide`);
  for (const element of document.querySelectorAll("h1, h2, p, li, dd, dt, summary, figcaption, .verdict, button")) {
    if (element.clientWidth > 0 && element.scrollWidth > element.clientWidth + 1) {
      faults.push(`cut: ${element.textContent.slice(0, 60)}`);
    }
  }
  for (const svg of document.querySelectorAll("figure > svg")) {
    const frame = svg.getBoundingClientRect();
    if (frame.width === 0) continue;
    const texts = [...svg.querySelectorAll("text")].map((t) => [t.textContent, t.getBoundingClientRect()]);
    texts.forEach(([word, box], k) => {
      if (box.left < frame.left - 1 || box.right > frame.right + 1 || box.bottom > frame.bottom + 1) {
        faults.push(`"${word}" leaves the drawing ${svg.getAttribute("aria-label")}`);
      }
      if (box.height < 8) faults.push(`"${word}" is ${box.height} pixels high`);
      for (const [other, rival] of texts.slice(k + 1)) {
        const wide = Math.min(box.right, rival.right) - Math.max(box.left, rival.left);
        const high = Math.min(box.bottom, rival.bottom) - Math.max(box.top, rival.top);
        if (wide > 1 && high > 3) faults.push(`"${word}" lies over "${other}" in ${svg.getAttribute("aria-label")}`);
      }
    });
  }
  return faults;
})()