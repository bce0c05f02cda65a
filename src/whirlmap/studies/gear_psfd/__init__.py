"""The paper: Chang-Jian's gear-bearing system with porous squeeze-film dampers."""
