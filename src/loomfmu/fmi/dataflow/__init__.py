"""On which inputs, parameters and time outputs depend, by the flow of data in a component's source."""
