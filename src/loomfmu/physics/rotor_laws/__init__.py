"""Laws by which a dobby's rotor turns over half a revolution of its shaft."""
