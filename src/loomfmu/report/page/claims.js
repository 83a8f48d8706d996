// A click on the place of a claim moves the cursor there.
for (const button of document.querySelectorAll("#claims .place"))
  button.addEventListener("click", () => loomfmu.seek(Number(button.dataset.position)));
