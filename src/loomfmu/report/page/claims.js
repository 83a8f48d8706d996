// A click on the place of a claim moves the cursor there.
document.getElementById("claims").addEventListener("click", event => {
  const button = event.target.closest(".place");
  if (button) loomfmu.seek(Number(button.dataset.position));
});
